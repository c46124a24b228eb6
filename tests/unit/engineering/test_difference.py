"""Differences between answers and samples: intervals, and the sentence that says which is better."""

import copy
import json
from functools import cache

import numpy as np
import pandas as pd
import pytest
from scipy import stats
from test_sample import STEEL, a_map

import asperity as asp
from asperity.core.units import shown_si
from asperity.engineering.records import DISCRETISATION, POSITIONS, Record
from asperity.engineering.sample import key_of
from asperity.engineering.show.comparison import _of_errors, _of_samples, compared


@cache
def answer_of(seed, hardness=None):
    body = STEEL if hardness is None else STEEL.replaced(hardness=hardness)
    return asp.run(a_map(seed), body, mean_pressure=200e6)


@cache
def sample_of(*seeds, hardness=None):
    return asp.pool({f"map {seed}": answer_of(seed, hardness) for seed in seeds})


def record(values, error=0.0):
    values = np.array(values)
    positions = stats.t.ppf(0.975, values.size - 1) * stats.sem(values) if values.size > 1 else 0.0
    errors = {DISCRETISATION: error, POSITIONS: positions}
    return Record("volume", float(values.mean()), "m", errors=errors)


def test_samples_differ_as_welch_says():
    first, second = [1.31e-6, 1.2e-6, 1.45e-6], [0.30e-6, 0.35e-6, 0.22e-6, 0.31e-6]
    values = [np.array(first), np.array(second)]
    found = _of_samples(record(first), record(second), values)
    welch = stats.ttest_ind(second, first, equal_var=False)
    low, high = welch.confidence_interval(0.95)
    assert (found.chance, found.error) == (pytest.approx(welch.pvalue), pytest.approx((high - low) / 2))
    wider = _of_samples(record(first, 1e-7), record(second, 1e-7), values)
    assert wider.error == pytest.approx(np.sqrt(found.error**2 + 2e-14))
    assert found.text == "-1.02 ± 0.27 µm"


def test_one_map_shows_no_chance_of_a_difference():
    first, second = (
        Record("volume", value, "m", errors={DISCRETISATION: 1e-8, POSITIONS: 2e-7}) for value in (3e-7, 4e-7)
    )
    found = _of_errors(first, second)
    assert found.error == pytest.approx(np.sqrt(2 * (1e-8**2 + 2e-7**2)))
    assert np.isnan(found.chance)


def test_single_maps_say_that_positions_are_not_known():
    """Each pair of one map of a surface, with errors by discretisation alone."""
    found = compared({"soft": answer_of(1), "hard": answer_of(1, hardness=4e9)})
    assert found.verdict.startswith("Not known whether hard is better: ")
    assert "; one map each: differences between positions are not known. " in found.verdict
    assert "The cases differ in body.hardness: " in found.verdict
    assert "p = " not in found.text()
    assert found.frame()["chance_hard"].isna().all()
    numbers = pd.concat(found._numbers().values())
    both = numbers[(numbers["soft"] != "") & (numbers["hard"] != "")]
    assert (both["difference"] != "").all()  # where an error is not known, too
    assert found.text().count("± not known") == 1
    mixed = compared({"several": sample_of(1, 2, 3), "one": answer_of(4)})
    assert "one is one map: differences between positions are not known" in mixed.verdict
    parts = compared(found.items)
    parts.__dict__["records"] = {
        name: {key: each.with_error(POSITIONS, 0.1 * abs(each.value)) for key, each in records.items()}
        for name, records in found.records.items()
    }
    assert "positions are estimated only from parts of one map. " in parts.verdict


def test_samples_are_judged_by_the_volume_above_yield():
    found = compared({"soft": sample_of(1, 2, 3, hardness=np.inf), "hard": sample_of(1, 2, 3, hardness=4e9)})
    key = ("stress", "lower", "volume above yield per area")
    difference = found.difference(key, "soft", "hard")
    values = [sample.values(sample[key[2]]) for sample in found.items.values()]
    assert difference.chance == pytest.approx(stats.ttest_ind(*values, equal_var=False).pvalue, rel=0.3)
    best = min(found.items, key=lambda name: found.items[name][key[2]].best)
    judged = f"{best} is better" if difference.chance < 0.05 else "No significant difference"
    text = found.records[best][key].best_text()
    assert found.verdict.startswith(f"{judged}: volume above yield per area {text} of {best} (3 maps), ")
    cause = "; most of the interval comes from differences between measurement positions."
    assert f"; p = {difference.chance:.2g}{cause}" in found.verdict


def test_fractions_above_yield_refer_to_one_depth():
    """Of all maps of both samples; without it a shallow volume has a large fraction."""
    found = compared({"few": sample_of(1, 2), "others": sample_of(3, 4)})
    depths = [answer_of(seed)["maximum depth above yield"].value for seed in (1, 2, 3, 4)]
    for records in found.records.values():
        volume, fraction = (
            records["stress", "lower", name]
            for name in ("volume above yield per area", "volume fraction above yield")
        )
        assert fraction.best == pytest.approx(volume.best / max(depths))
    assert f"volume fraction above yield, down to {shown_si(max(depths), 'm', 3)}" in str(found)


def test_three_answers_and_their_files(tmp_path):
    found = compared([answer_of(1), answer_of(1, 4e9), sample_of(1, 2)])
    names = [*found.items]
    assert names == ["patch 1 1", "patch 1 2", "map 1"]
    table = found.frame()
    row = table.set_index("quantity").loc["maximum pressure"]
    assert row["value_map 1"] == sample_of(1, 2)["maximum pressure"].best
    assert row["difference_map 1"] == row["value_map 1"] - row["value_patch 1 1"]
    with pytest.raises(ValueError, match="the answer of patch 1 is needed in a folder; write it first"):
        found.write(tmp_path / "new")  # which could not be opened
    assert not (tmp_path / "new").exists()
    page = found.page(tmp_path)
    assert page.index(found.records["map 1"][key_of(found.decisive[0])].best_text()) < page.index("<img ")
    assert page.index(found.verdict.split(";")[0]) < page.index("<img ") < page.index("<h2>All numbers</h2>")
    assert "<script" not in page
    assert all(name in json.dumps(page) for name in names)
    with pytest.raises(ValueError, match="answers: at least two"):
        compared([answer_of(1)])


def test_an_answer_that_another_replaced_is_not_compared(tmp_path, without_pictures):
    answers = [copy.copy(answer_of(seed)) for seed in (1, 2)]
    for each in answers:
        each.write(tmp_path / "same")
    with pytest.raises(ValueError, match="same: holds one answer, two that are compared were written there"):
        compared(answers).write(tmp_path / "compared")


def test_comparison_is_opened_and_moved_with_its_answers(tmp_path, without_pictures):
    answers = {f"before/{name}": copy.copy(answer_of(seed)) for seed, name in ((1, "a"), (2, "b"))}
    for name, answer in answers.items():
        answer.write(tmp_path / name)
    sample = asp.pool([*map(tmp_path.joinpath, answers)])
    assert sample.names == ("a", "b")
    found = sample.compare(*answers.values())
    found.write(str(tmp_path / "before/compared"))
    again = asp.open_answer((tmp_path / "before").rename(tmp_path / "after") / "compared")
    assert again.verdict == found.verdict
    pd.testing.assert_frame_equal(again.frame(), found.frame())
    assert again.items["a 2"]["maximum pressure"] == answers["before/a"].record("maximum pressure")
    assert again.items["a 1"].record("maximum pressure") == sample["maximum pressure"]
    assert found.verdict.split(";")[0] in again._repr_html_()
    assert again.items["b"].report().startswith("<!DOCTYPE html>")

"""A killed study loses no finished result, and continues with the same command."""

import os
import runpy
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import asdict
from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure
from project import QUICK, ROOT, STUDY, snakemake_here

from asperity.paper import figures
from asperity.results import dataset
from asperity.results.atomic import locked
from asperity.settings.study import read_study
from asperity.stress.analysis import SOUGHT
from asperity.study import progress_and_log
from asperity.study.stages.contact import press_surface
from asperity.study.stages.stress import stress_of_seed
from asperity.study.stages.surface import make_surface


def test_killed_study_continues_without_loss(killed_study, quick_study, monkeypatch):
    """Also if the killed job has left half of its result: Snakemake marks results that are being made."""
    _, results, killed, finished = killed_study
    assert {path: path.stat().st_mtime_ns for path in finished} == finished
    monkeypatch.chdir(quick_study.folder)
    config, name = read_study(QUICK[1:]), killed.parent.name
    surface = make_surface(config["surfaces"][name], 1)
    settings = dataset.settings_of(dataset.read(killed))
    contact = press_surface(surface, config["layer"], settings["contact"])
    stress = stress_of_seed(contact, config["layer"], settings["stress"], ["free"], [*SOUGHT, "xy"])
    for stage, expected in {"surface": surface, "contact": contact, "stress": stress}.items():
        written = dataset.read(results / stage / name / "seed1.nc")
        assert set(written.variables) >= set(expected.variables), stage
        for variable in expected.variables:
            np.testing.assert_array_equal(written[variable], expected[variable], f"{stage}: {variable}")


def test_a_study_does_not_write_beside_another(quick_study):
    """The other one is another thread, which holds the lock alone."""
    folder, results, _ = quick_study
    stress = results / "stress/hurst_08/seed1.nc"
    before = stress.stat().st_mtime_ns
    with ThreadPoolExecutor(1) as other:
        lock = locked(results)
        other.submit(lock.__enter__).result()
        said = snakemake_here(folder, *STUDY, "--force", "--", "../own results/stress/hurst_08/seed1.nc")
        other.submit(lock.__exit__, None, None, None).result()
    assert said.splitlines()[-1].startswith(f"study: ../own results: process {os.getpid()} on ")
    assert stress.stat().st_mtime_ns == before


def test_figures_that_a_killed_job_has_drawn_are_kept(quick_study, tmp_path, monkeypatch):
    """Killed at the second of three, and with a label that Snakemake's report would take for a command."""
    monkeypatch.chdir(quick_study.folder)
    config = read_study(QUICK[1:]) | {"figures": "own"}
    surfaces, names = config["studies"]["hurst"], ["spectrum_hurst", "heights_hurst", "peaks_hurst"]
    described = {name: figures.figures_of(config)[name] for name in names}
    labels, drawn = dict.fromkeys(surfaces, "{{1 + 1}}"), []

    def path(stage, surface):
        return str(quick_study.results / stage / f"{surface}{'' if stage == 'statistics' else '/seed1'}.nc")

    def killed_at_the_second(figure, _):
        drawn.append(figure.name)
        if len(drawn) == 2:
            raise KeyboardInterrupt
        return Figure()

    monkeypatch.setattr(figures, "draw", killed_at_the_second)
    monkeypatch.setattr(progress_and_log, "job", lambda _: nullcontext(lambda *_: None))
    entries = {
        name: {
            "description": asdict(figure),
            "labels": labels,
            "results": figure.results(config["studies"], path),
        }
        for name, figure in described.items()
    }
    output = {
        key: [str(tmp_path / f"{name}{suffix}") for name in names]
        for key, suffix in {"png": ".png", "pdf": ".pdf", "caption": ".rst"}.items()
    }
    given = SimpleNamespace(
        input=[path("statistics", surface) for surface in surfaces],
        params=SimpleNamespace(figures=entries, drawn=str(tmp_path / "drawn")),
        output=SimpleNamespace(**output),
    )
    script, given = str(ROOT / "workflow/scripts/figures.py"), {"snakemake": given}
    with pytest.raises(KeyboardInterrupt):
        runpy.run_path(script, given)
    assert not list(tmp_path.glob("*.png"))
    runpy.run_path(script, given)
    assert drawn == [names[0], names[1], *names[1:]]
    assert {path.stem for path in tmp_path.glob("*.pdf")} == {*names}
    caption = (tmp_path / "peaks_hurst.rst").read_text(encoding="utf-8")
    assert caption.startswith("Distributions of the peaks")
    assert r"{\ {1 + 1}}, σ_VM" in caption
    assert not (tmp_path / "drawn").exists()

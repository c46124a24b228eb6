"""The cost model: growth with grid, loads, ratios and planes, and its fit to the benchmarks of a study."""

import pytest

from asperity.settings.accuracy import PRESETS
from asperity.study.cost.benchmark import fitted, job_costs
from asperity.study.cost.model import coefficients, job_cost
from asperity.study.cost.plan import PlannedContact, contact_cost


@pytest.mark.parametrize("stage", ["contact", "load-area curve", "stress", "statistics"])
def test_cost_is_linear_in_the_nodes(stage):
    none, small, large = (job_cost(stage, nodes) for nodes in (0, 1024**2, 2048**2))
    assert large.memory - none.memory == pytest.approx(4 * (small.memory - none.memory))
    assert large.disk - none.disk == pytest.approx(4 * (small.disk - none.disk))
    assert large.calculation_seconds == pytest.approx(4 * small.calculation_seconds)
    assert large.memory > small.memory > none.memory > 0


@pytest.mark.parametrize(
    ("points", "ratios", "measured"),
    [(1024, 2, 0.453e9), (2048, 2, 1.101e9), (2048, 8, 1.120e9), (16384, 4, 18.4e9)],
)
def test_memory_of_a_stress_is_covered_and_not_wasted(points, ratios, measured):
    """The largest of the study of the paper, at tolerance 1e-4; `studies/challenge` has 16384²."""
    assert measured < job_cost("stress", points**2, ratios).memory < 1.2 * measured


def test_study_and_plan_have_the_same_times():
    contact = PlannedContact(0.8, 1 / 8, 1 / 64, 0.1, loads=3, ratios=2)
    seconds, memory = contact_cost(contact, PRESETS["paper"])
    jobs = [job_cost("load-area curve", 512**2, 3), job_cost("stress", 512**2, 2)]
    assert seconds == pytest.approx(sum(job.seconds for job in jobs))
    assert memory == max(job.memory for job in jobs)


def test_fit_finds_the_costs_of_a_study(tmp_path):
    """Costs that follow the model are fitted exactly; of others the memory is never too small."""
    (tmp_path / "benchmark").mkdir()
    columns = "max_rss", "cpu_time", "rule_name", "wildcards", "resources"
    jobs = [(job, 512**2 * 4**size, n) for job in ("contact", "stress") for size in range(4) for n in (1, 4)]
    for number, (rule, nodes, repetitions) in enumerate(jobs):
        job = "load-area curve" if rule == "contact" and repetitions > 1 else rule
        cost = job_cost(job, nodes, repetitions)
        resources = {"mem_mb": 1, "grid_nodes": nodes, "repetitions": repetitions}
        row = cost.memory / 1e6, cost.seconds, rule, {"surface": "a"}, resources
        text = "\n".join("\t".join(map(str, line)) for line in (columns, row))
        (tmp_path / f"benchmark/{number}.tsv").write_text(text)
    found = fitted(job_costs(tmp_path))
    for job in ("contact", "stress"):
        for name, value in found.loc[job].items():
            assert value == pytest.approx(coefficients()[job][name], rel=1e-2, abs=1e-3), (job, name)
    worse = job_costs(tmp_path).query("grid_nodes <= 2048**2")
    worse["memory_MB"] *= 1 + worse.index % 2
    fit = fitted(worse).loc["stress"]
    for job in worse[worse["rule"] == "stress"].itertuples():
        per_node = fit["memory_per_node"] + (job.repetitions - 1) * fit["memory_per_further"]
        assert fit["memory"] + 1e-6 * job.grid_nodes * per_node > 0.99 * job.memory_MB

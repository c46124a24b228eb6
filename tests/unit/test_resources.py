"""The cost model: growth with grid, loads, ratios and settings, and agreement with stored measurements."""

from dataclasses import replace

import pytest

from asperity.study.config.presets import PRESETS
from asperity.study.cost.measured import load
from asperity.study.cost.model import CALCULATION_STAGES, announce, job_cost
from asperity.study.cost.plan import scene_cost
from asperity.study.cost.scene import Scene

PAPER = PRESETS["paper"]
STAGES = ["surface", "contact", "stress", "statistics"]


@pytest.mark.parametrize("stage", STAGES)
def test_memory_and_files_are_linear_in_the_nodes_and_time_nearly(stage):
    none, small, large = (job_cost(stage, nodes) for nodes in (0, 1024**2, 2048**2))
    assert large.memory - none.memory == pytest.approx(4 * (small.memory - none.memory))
    assert large.disk - none.disk == pytest.approx(4 * (small.disk - none.disk))
    assert large.memory > small.memory > none.memory > 0
    assert 3 < large.calculation_seconds / small.calculation_seconds < 4.5


@pytest.mark.parametrize("stage", ["contact", "stress", "statistics"])
def test_more_loads_ratios_or_seeds_need_more(stage):
    one, two, three = (job_cost(stage, 10**6, repetitions) for repetitions in (1, 2, 3))
    assert three.seconds > two.seconds > one.seconds
    assert three.memory >= two.memory > one.memory


@pytest.mark.parametrize(
    ("stage", "coarser"),
    [
        ("contact", {"contact_tolerance": 1e-3}),
        ("stress", {"depth_tolerance": 1e-2}),
        ("stress", {"depth_spacing": 2.0}),
    ],
)
def test_coarser_settings_take_less_time(stage, coarser):
    nodes = 1024**2
    fast = job_cost(stage, nodes, accuracy=replace(PAPER, **coarser))
    assert fast.calculation_seconds < 0.95 * job_cost(stage, nodes).calculation_seconds


def test_memory_agrees_with_that_of_the_stored_measurement():
    """The peak of all stages in one process, several loads and ratios: that of the stress."""
    base, per_node = load().memory
    for points in (512, 1024, 2048, 4096):
        expected = base + per_node * points**2
        assert job_cost("stress", points**2, 4).memory == pytest.approx(expected, rel=0.25)


@pytest.mark.parametrize("name", PRESETS)
def test_the_time_of_a_preset_is_within_a_factor_of_two_of_the_stored_measurement(name):
    """Of the surfaces with λ_l = L/8, λ_s = L/32 and a contact area of 10 %."""
    seconds, _ = scene_cost(Scene(0.8, 1 / 8, 1 / 32, 0.1), PRESETS[name])
    assert 0.5 < seconds / load().presets[name]["seconds"] < 2


def test_the_study_and_the_plan_have_the_same_times():
    scene = Scene(0.8, 1 / 8, 1 / 64, 0.1, loads=(0.02, 0.05), poisson=(0.0, 0.33))
    seconds, memory = scene_cost(scene, PAPER)
    jobs = [
        job_cost(stage, 512**2, {"surface": 1, "contact": 3, "stress": 2}[stage])
        for stage in CALCULATION_STAGES
    ]
    assert seconds == pytest.approx(sum(job.seconds - job.fixed_seconds for job in jobs))
    assert memory == max(job.memory for job in jobs)


def test_the_announcement_sums_jobs_time_and_memory():
    contact, claims = job_cost("contact", 1024**2), job_cost("claims")
    line = announce([contact, contact, claims], cores=2, factor=60)
    total = 2 * contact.seconds + claims.seconds
    on_two = max(total / 2, claims.seconds)
    assert line == (
        f"plan: 3 jobs, about {total:.0f} min of one processor, {on_two:.0f} min on 2 cores, "
        f"at most {claims.memory / 2**30:.1f} GiB in one job"
    )

"""Plans compared with the calculations they propose: three targets, on scenes that were not used in the
measurement.

    python benchmarks/plan.py

An error, a time and a memory are asked for, and the proposed settings are calculated. Errors are those
against 24 nodes on the shortest wavelength with all other settings converged. Times are processor times on
one thread, and have to be within a factor of two of the plan, as has the memory; errors have to be within
their bounds.
"""

from dataclasses import replace

from asperity.accuracy.evaluation import Scene, evaluate, output_errors
from asperity.accuracy.measurement import CONVERGED
from asperity.accuracy.plan import PEAKS, Target, propose
from asperity.accuracy.tables import markdown, percent

SMALL = Scene(hurst=0.5, wavelength_long=1 / 6, wavelength_short=1 / 24, area_fraction=0.06, seed=7)
LARGE = Scene(hurst=0.6, wavelength_long=1 / 5, wavelength_short=1 / 48, area_fraction=0.15, seed=3)
STEEP = replace(SMALL, hurst=0.3, area_fraction=0.1, seed=11)

TARGETS = (
    ("error of 15 % in peaks", SMALL, Target(error=0.15, one_surface=True)),
    ("2 seconds", STEEP, Target(seconds=2.0, one_surface=True)),
    ("0.45 GiB", LARGE, Target(memory=0.45 * 2**30, one_surface=True)),
)

COLUMNS = (
    "asked for",
    "nodes",
    "depth spacing",
    "time (s): plan",
    "took",
    "GiB: plan",
    "took",
    "error: bound",
    "was",
)


def largest_error(scene, accuracy):
    """Largest error of the peaks, against the converged calculation at the same load."""
    reference = evaluate(scene, replace(CONVERGED, points_per_wavelength=24.0))
    evaluation = evaluate(scene, accuracy, reference.mean_pressure)
    errors = output_errors(evaluation, reference)
    return max(abs(errors[name]) for name in PEAKS)


def within_factor_of_two(planned, taken):
    """True if plan and calculation differ by less than a factor of two."""
    return planned / 2 < taken < 2 * planned


def main():
    rows = [COLUMNS]
    failures = []
    for name, scene, target in TARGETS:
        plan = propose([scene], target)
        evaluate(replace(SMALL, wavelength_short=1 / 12), plan.accuracy)  # compiles
        evaluation = evaluate(scene, plan.accuracy)
        memory = evaluation.costs["peak_memory"]
        bound, error = plan.error(PEAKS), largest_error(scene, plan.accuracy)
        cells = [
            name,
            f"{plan.accuracy.points(scene.wavelength_short)}²",
            f"{plan.accuracy.depth_spacing:g}",
            f"{plan.seconds:.2f}",
            f"{evaluation.seconds:.2f}",
            f"{plan.memory / 2**30:.2f}",
            f"{memory / 2**30:.2f}",
            percent(bound),
            percent(error),
        ]
        rows.append(cells)
        if not within_factor_of_two(plan.seconds, evaluation.seconds):
            failures.append(f"{name}: time")
        if not within_factor_of_two(plan.memory, memory):
            failures.append(f"{name}: memory")
        if error > bound:
            failures.append(f"{name}: error")
    print(markdown(rows))
    assert not failures, f"plans that did not hold: {', '.join(failures)}"


if __name__ == "__main__":
    main()

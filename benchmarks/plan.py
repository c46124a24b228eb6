"""Plans against what really happens: three targets, on scenes that were not used to make plans.

    python benchmarks/plan.py

An error, a time and a memory are asked for; the settings proposed are run, and the errors are those against
24 nodes on the shortest wavelength with everything else converged. Processor time on one thread.
"""

from dataclasses import replace

from asperity.accuracy.measurement import EXACT, Scene, errors, evaluate
from asperity.accuracy.model import percent
from asperity.accuracy.plan import PEAKS, propose

SMALL = Scene(hurst=0.5, wavelength_long=1 / 6, wavelength_short=1 / 24, area_fraction=0.06, seed=7)
LARGE = Scene(hurst=0.6, wavelength_long=1 / 5, wavelength_short=1 / 48, area_fraction=0.15, seed=3)
STEEP = replace(SMALL, hurst=0.3, area_fraction=0.1, seed=11)

TARGETS = (
    ("error of 15 % in peaks", SMALL, {"error": 0.15}),
    ("2 seconds", STEEP, {"seconds": 2.0}),
    ("0.45 GiB", LARGE, {"memory": 0.45 * 2**30}),
)


def seconds(costs):
    return costs["surface_seconds"] + costs["contact_seconds"] + costs["stress_seconds"]


def largest_error(outcome, scene, knobs):
    """Of the peaks, against the converged outcome at the same load."""
    reference = evaluate(scene, replace(EXACT, points_per_wavelength=24.0))
    again = evaluate(scene, knobs, mean_pressure=reference.mean_pressure)
    found = errors(again, reference)
    return max(abs(found[name]) for name in PEAKS)


def main():
    head = "asked for | nodes | depth spacing | time (s): plan | took | GiB: plan | took | error: bound | was"
    print(f"| {head} |")
    print("|" + "---|" * 9)
    for name, scene, target in TARGETS:
        plan = propose([scene], PEAKS, one_surface=True, **target)
        evaluate(replace(SMALL, wavelength_short=1 / 12), plan.knobs)  # compiles
        outcome = evaluate(scene, plan.knobs)
        wrong = largest_error(outcome, scene, plan.knobs)
        cells = [
            name,
            f"{plan.knobs.points(scene.wavelength_short)}²",
            f"{plan.knobs.depth_spacing:g}",
            f"{plan.cost.seconds:.2f}",
            f"{seconds(outcome.costs):.2f}",
            f"{plan.cost.memory / 2**30:.2f}",
            f"{outcome.costs['peak_memory'] / 2**30:.2f}",
            percent(plan.error(PEAKS)),
            percent(wrong),
        ]
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()

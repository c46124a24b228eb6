"""Solution for a sequence of loads, each started from what the last two solutions predict."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any

from numpy.typing import ArrayLike

from asperity.contact.path_prediction import PathPrediction
from asperity.contact.solution import Contact
from asperity.contact.solver import solve
from asperity.elasticity.two_bodies import Solid
from asperity.types import Progress


def solve_path(
    height: ArrayLike,
    solid: Solid,
    length: float | tuple[float, float] = 1.0,
    *,
    area_fractions: Sequence[float] | None = None,
    mean_pressures: Sequence[float] | None = None,
    forces: Sequence[float] | None = None,
    approaches: Sequence[float] | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Iterator[Contact]:
    """Solve for one load after the other, each started from what the last two solutions predict.

    Parameters
    ----------
    height, solid, length
        As for `solve`.
    area_fractions, mean_pressures, forces, approaches : sequence of float
        Exactly one of them.
    progress : callable, optional
        Called as progress(done, total), where a load counts as one.
    **settings
        Passed to `solve`.

    Yields
    ------
    Contact

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> solid = asp.Layer(young=1.0, poisson=0.3)
    >>> for contact in asp.solve_path(height, solid, mean_pressures=[1e-4, 2e-4, 4e-4]):
    ...     print(f"load {contact.mean_pressure:.0e}, area {contact.area_fraction:.3f}")
    load 1e-04, area 0.016
    load 2e-04, area 0.026
    load 4e-04, area 0.050
    """
    paths = {
        "area_fraction": area_fractions,
        "mean_pressure": mean_pressures,
        "force": forces,
        "approach": approaches,
    }
    given = {kind: list(values) for kind, values in paths.items() if values is not None}
    if len(given) != 1:
        raise ValueError(
            "exactly one of area_fractions, mean_pressures, forces, approaches is needed, "
            f"got {', '.join(given) if given else 'none'}"
        )
    ((kind, values),) = given.items()
    return _solve_each(partial(solve, height, solid, length, **settings), kind, values, progress)


def _solve_each(
    solve_one: Callable[..., Contact], kind: str, values: Sequence[float], progress: Progress | None
) -> Iterator[Contact]:
    """Solve for each value of the imposed quantity, started from what the last two solutions predict."""
    prediction = PathPrediction(kind)

    def solved(index: int, value: float) -> Contact:
        of_load = None if progress is None else partial(_report, progress, index, len(values))
        contact = solve_one(**{kind: value}, initial=prediction.pressure(value), progress=of_load)
        prediction.record(value, contact)
        if progress is not None:
            progress(index + 1, len(values))
        return contact

    # A function of its own solves, so that nothing holds a contact that the caller has done with.
    for index, value in enumerate(values):
        yield solved(index, value)


def _report(progress: Progress, index: int, count: int, done: float, total: float) -> None:
    """Report the progress of one load as progress of the path."""
    progress(index + done / total, count)

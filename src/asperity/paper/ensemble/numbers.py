"""Numbers that an ensemble can estimate: those of the claims, and some of a single surface.

Every number is one for each seed, and the ensemble estimates its mean over seeds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.errors import shown
from asperity.paper.claims.evidence import Evidence, Fixed, Measure, Options
from asperity.paper.claims.readings import Number as OfSurfaces
from asperity.paper.claims.readings import Reading, percentile, single
from asperity.paper.claims.statements import CLAIMS
from asperity.types import Array


class Number(NamedTuple):
    """A number of each seed.

    Parameters
    ----------
    quantity : str
        What exactly is measured.
    measure : callable
        As of a claim.
    """

    quantity: str
    measure: Measure


SINGLE: dict[str, Number] = {
    f"{name}_{role}": Number(f"{quantity}, {role.replace('_hurst', '')} H", single(reading, role))
    for role in ("small_hurst", "large_hurst")
    for name, quantity, reading in (
        ("proportionality", "a E*ḡ/P₀ at the area of the study", Reading("seed_proportionality")),
        ("gradient", "rms gradient over the true contact", Reading("seed_gradient_rms_contact")),
        ("von_mises_p99", "99th percentile of the von Mises peaks over E*ḡ", percentile("von_mises")),
    )
}
"""Numbers of one surface, by the role of the surface in the claims."""


@cache
def numbers() -> dict[str, Number]:
    """All numbers that depend on random surfaces, by the identifier of their claim or their name."""
    claimed = {claim.identifier: Number(claim.quantity, claim.measure) for claim in CLAIMS}
    return SINGLE | {name: number for name, number in claimed.items() if _asked(number.measure)}


def number(name: str) -> Number:
    """The number of this name.

    Raises
    ------
    ValueError
        If there is none.
    """
    if name not in numbers():
        raise ValueError(f"claim = {shown(name)}: one of {', '.join(sorted(numbers()))} is needed")
    return numbers()[name]


def surfaces_of(name: str, roles: Mapping[str, str]) -> dict[str, str]:
    """Role → surface, of the surfaces that a number depends on.

    Parameters
    ----------
    name : str
    roles : mapping
        As of `asperity.paper.claims.sources.roles`.

    Raises
    ------
    ValueError
        If there is no such number, or if the configuration has no surface in one of the roles.
    """
    needed = _asked(number(name).measure)
    for role in needed:
        if role not in roles:
            raise ValueError(f"claim = {name}: a configuration with a surface as {role} is needed")
    return {role: roles[role] for role in needed}


def values(name: str, statistics: Mapping[str, xr.Dataset]) -> Array:
    """The number for each seed.

    Parameters
    ----------
    name : str
    statistics : mapping
        Role → numbers of the seeds of its surface, as of `asperity.pipeline.ensemble.sample`.

    Raises
    ------
    ValueError
        If there is nothing to measure on a surface.
    """
    found = number(name).measure(Evidence(statistics))
    assert not isinstance(found, Fixed)
    unknown = found["seed"].values[~np.isfinite(found.values)].tolist()
    if unknown:
        raise ValueError(f"claim = {name}: nothing to measure with seed {', '.join(map(str, unknown[:5]))}")
    return found.values


def _asked(measure: Measure) -> tuple[str, ...]:
    """Roles of the surfaces that a measure asks for, in the order of asking."""
    if isinstance(measure, OfSurfaces):
        return tuple(dict.fromkeys(role for _, role in measure.parts))
    evidence = _RecordedEvidence()
    # After the last surface, numpy or xarray may reject the placeholder: the roles are known then.
    with suppress(TypeError, ValueError, AttributeError, LookupError):
        measure(evidence)  # type: ignore[arg-type]
    return tuple(evidence.roles)


class _Placeholder:
    """Stands for the numbers of a surface: whatever is taken from it or made of it is a placeholder again."""

    def _same(self, *_: Any, **__: Any) -> _Placeholder:
        return self

    def __getattr__(self, name: str) -> _Placeholder:
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __contains__(self, item: object) -> bool:
        return False

    __call__ = __getitem__ = __neg__ = _same
    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __truediv__ = __rtruediv__ = _same


class _RecordedEvidence:
    """Evidence that records the roles of the surfaces that a measure asks for."""

    def __init__(self) -> None:
        self.roles: dict[str, None] = {}
        self.options: Options = {}

    def under(self, options: Options) -> _RecordedEvidence:
        return self

    def statistics(self, role: str) -> _Placeholder:
        self.roles[role] = None
        return _Placeholder()

    def dataset(self, name: str) -> Iterable[Any]:
        raise LookupError(name)

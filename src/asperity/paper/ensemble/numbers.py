"""Numbers that an ensemble can estimate: those of the claims, and some of a single surface.

Every number is one for each seed, and the ensemble estimates its mean over seeds. The name of a number is the
identifier of its claim; options of the readings follow after commas, as in ``one_and_a_half,lateral=free``.
Choices that are not named have the study's own option.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

import numpy as np
import xarray as xr

from asperity.config.schema import accepted, setting
from asperity.errors import shown
from asperity.paper.claims import readings
from asperity.paper.claims.evidence import Evidence, Options
from asperity.paper.claims.readings import Reading, percentile, single
from asperity.paper.claims.sources import SKEWED, role_of_delta
from asperity.paper.claims.statements import CLAIMS
from asperity.types import Array

LISTED: dict[str, tuple[str, ...]] = {"lateral": (), "shear": ("xz",)}
"""Choices whose options are in the samples if section ``readings`` lists them → those that always are."""


class Number(NamedTuple):
    """A number of each seed.

    Parameters
    ----------
    quantity : str
        What exactly is measured.
    measure : asperity.paper.claims.readings.Number
        As of a claim.
    options : mapping
        Choice of the readings → option, where it is not the study's own.
    """

    quantity: str
    measure: readings.Number
    options: Options = MappingProxyType({})

    @property
    def roles(self) -> tuple[str, ...]:
        """Roles of the surfaces on which the number depends."""
        delta = self.options.get("delta")
        return tuple(
            role if delta is None or role not in SKEWED else role_of_delta(role, delta)
            for role in self.measure.roles
        )


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
    return SINGLE | {
        claim.identifier: Number(claim.quantity, claim.measure)
        for claim in CLAIMS
        if isinstance(claim.measure, readings.Number)
    }


def full_name(name: str, options: Iterable[str]) -> str:
    """Name of a number under a reading, from texts such as ``lateral=free``."""
    return ",".join([name, *sorted(options)])


def number(name: str) -> Number:
    """The number of this name, with the options that the name has.

    Raises
    ------
    ValueError
        If there is no such number, if it does not depend on a choice, or a choice has no such option.
    """
    base, *texts = name.split(",")
    if base not in numbers():
        raise ValueError(f"claim = {shown(base)}: one of {', '.join(sorted(numbers()))} is needed")
    found = numbers()[base]
    options = {}
    for text in texts:
        choice, _, option = text.partition("=")
        if choice not in found.measure.choices:
            known = ", ".join(found.measure.choices) or "no choice"
            raise ValueError(f"reading {shown(text)}: the number {base} depends on {known}")
        options[choice] = _option(choice, option)
    return found._replace(options=options)


def _option(choice: str, text: str) -> Any:
    """Option of a choice from its text."""
    entry = setting(f"readings.{choice}")["items"]
    known = {str(option): option for option in entry.get("enum", ())}
    if text in known:
        return known[text]
    try:
        if not known:
            return float(text)
    except ValueError:
        pass
    raise ValueError(f"reading {shown(f'{choice}={text}')}: {accepted(entry)} is needed")


def surfaces_of(name: str, roles: Mapping[str, str], choices: Mapping[str, Any]) -> dict[str, str]:
    """Role → surface, of the surfaces that a number depends on.

    Parameters
    ----------
    name : str
    roles : mapping
        As of `asperity.paper.claims.sources.roles`, and for each δ those of `deltas`.
    choices : mapping
        Section ``readings`` of the configuration.

    Raises
    ------
    ValueError
        If there is no such number, if the configuration has no surface in one of the roles, or if the samples
        do not have the option of a choice.
    """
    wanted = number(name)
    for choice, always in LISTED.items():
        listed = choices.get(choice, ())
        if choice in wanted.options and wanted.options[choice] not in (*always, *listed):
            raise ValueError(
                f"claim = {name}: readings.{choice} = {shown(listed)}: "
                f"a configuration that lists {wanted.options[choice]} there is needed"
            )
    for role in wanted.roles:
        if role not in roles:
            raise ValueError(f"claim = {name}: a configuration with a surface as {role} is needed")
    return {role: roles[role] for role in wanted.roles}


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
    wanted = number(name)
    surfaces = {role: _laterally(data, wanted.options.get("lateral")) for role, data in statistics.items()}
    found = wanted.measure(Evidence(surfaces, options=wanted.options))
    unknown = found["seed"].values[~np.isfinite(found.values)].tolist()
    if unknown:
        raise ValueError(f"claim = {name}: nothing to measure with seed {', '.join(map(str, unknown[:5]))}")
    return found.values


def _laterally(statistics: xr.Dataset, lateral: str | None) -> xr.Dataset:
    """The numbers under one condition of the uniform mode, by default the study's own, which is the first."""
    own = lateral or str(statistics["lateral"].values[0])
    return statistics.sel(lateral=own, drop=True).assign_attrs(uniform_mode=f"laterally {own}")

"""What the paper says, sentence by sentence, beside what is measured, and whether it holds.

A claim is a number with the region in which the sentence wants it. One rule decides all of them, `judge`:
the 95 % interval of the mean over seeds (Student's t; for comparisons of two surfaces the differences are
paired, one seed on both sides) lies inside the region: *holds*; outside: *does not hold*; across its edge, or
one seed only: *not decided*. What does not depend on random numbers has its numerical uncertainty for an
interval. A claim whose surfaces or datasets the configuration lacks stays in the table, with *no data*.
The claims themselves stand in `asperity.paper.claims.statements`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from scipy.special import stdtrit

import asperity
from asperity.pipeline.summary import Summary
from asperity.types import Array

HOLDS, FAILS, UNDECIDED, NO_DATA = "holds", "does not hold", "not decided", "no data"
VERDICTS = (HOLDS, FAILS, UNDECIDED, NO_DATA)

CONFIDENCE = 0.95


class MissingEvidenceError(LookupError):
    """The configuration has no surface, or the study no dataset, for a claim."""


class Region(NamedTuple):
    """Where a claim wants its number."""

    low: float
    high: float

    def __str__(self) -> str:
        if np.isinf(self.high):
            return f"> {self.low:g}"
        return f"< {self.high:g}" if self.low <= 0 else f"{self.low:g} to {self.high:g}"


class Fixed(NamedTuple):
    """A number that no random surface enters, and its numerical uncertainty."""

    value: float
    uncertainty: float = 0.0


@dataclass(frozen=True)
class Evidence:
    """What claims are decided on.

    Parameters
    ----------
    members : mapping
        Role of a surface, of `roles` → its summaries, one for each seed, in one order of seeds.
    validation : mapping
        Name → dataset of `asperity.validation.comparisons`.
    """

    members: Mapping[str, Sequence[Summary]]
    validation: Mapping[str, xr.Dataset] = field(default_factory=dict)

    def each_seed(self, measure: Callable[..., float], *wanted: str) -> Array:
        """A number for each seed from the summaries of one or more roles."""
        for role in wanted:
            if not self.members.get(role):
                raise MissingEvidenceError(f"no surface as {role}")
        return np.array([measure(*s) for s in zip(*(self.members[r] for r in wanted), strict=True)])

    def dataset(self, name: str) -> xr.Dataset:
        """A dataset of the validation."""
        if name not in self.validation:
            raise MissingEvidenceError(f"no dataset {name}")
        return self.validation[name]


Measure = Callable[[Evidence], "Array | Fixed"]


@dataclass(frozen=True)
class Claim:
    """A sentence of the paper as a number.

    Parameters
    ----------
    identifier : str
    section : str
        Of the paper.
    sentence : str
        In our words.
    quantity : str
        What is measured, exactly.
    region : Region
        Where the sentence wants it.
    measure : callable
        Evidence → one number for each seed, or `Fixed`; raises `MissingEvidenceError`.
    """

    identifier: str
    section: str
    sentence: str
    quantity: str
    region: Region
    measure: Measure


@dataclass(frozen=True)
class Finding:
    """A claim with its verdict.

    Parameters
    ----------
    claim : Claim
    value : float
        Mean over seeds.
    error : float
        Standard error over seeds, or the numerical uncertainty; NaN with one seed.
    low, high : float
        The interval that decides.
    seeds : int
        0 if no random surface enters.
    verdict : one of `VERDICTS`
    why : str
        What is missing, of *no data*.
    shift : float
        What the continuum limit adds to the value, where `Continuum` knows it; else NaN.
    shift_error : float
    """

    claim: Claim
    value: float
    error: float
    low: float
    high: float
    seeds: int
    verdict: str
    why: str = ""
    shift: float = np.nan
    shift_error: float = np.nan


def judge(claim: Claim, evidence: Evidence) -> Finding:
    """Decide a claim by the rule at the head of this module."""
    try:
        found = claim.measure(evidence)
    except MissingEvidenceError as missing:
        return Finding(claim, np.nan, np.nan, np.nan, np.nan, 0, NO_DATA, str(missing))
    unknown = int(np.sum(~np.isfinite(found)))
    if unknown:
        why = f"nothing to measure in {unknown} of {np.size(found)} numbers"
        return Finding(claim, np.nan, np.nan, np.nan, np.nan, 0, NO_DATA, why)
    if isinstance(found, Fixed):
        seeds, value, error = 0, *found
        half = error
    else:
        seeds, value, error = found.size, float(found.mean()), np.nan
        if seeds > 1:
            error = float(found.std(ddof=1) / np.sqrt(seeds))
        half = float(stdtrit(seeds - 1, 0.5 + CONFIDENCE / 2)) * error if seeds > 1 else np.nan
    low, high = value - half, value + half
    return Finding(claim, value, error, low, high, seeds, _verdict(low, high, claim.region))


def _verdict(low: float, high: float, region: Region) -> str:
    if region.low <= low and high <= region.high:
        return HOLDS
    if high < region.low or low > region.high:
        return FAILS
    return UNDECIDED


# Roles: which surface of the configuration stands for which word of the paper.


def roles(studies: Mapping[str, Sequence[str]], surfaces: Mapping[str, Mapping[str, Any]]) -> dict[str, str]:
    """Surfaces of the configuration by the part that they play in the claims.

    Parameters
    ----------
    studies, surfaces : mappings
        Sections of these names of the configuration.

    Returns
    -------
    dict
        Role → name of a surface. A role that no surface plays is left out.
    """

    def play(study: str, parts: Sequence[str], key: Callable[[Mapping[str, Any]], float]) -> dict[str, str]:
        names = sorted((n for n in studies.get(study, ()) if n in surfaces), key=lambda n: key(surfaces[n]))
        return dict(zip(parts, names, strict=True)) if len(names) == len(parts) else {}

    cutoffs: tuple[str, ...] = ("long_cutoff", "middle_cutoff", "short_cutoff")
    if len(studies.get("kurtosis", ())) == 2:
        cutoffs = cutoffs[::2]
    return {
        **play("hurst", ("small_hurst", "large_hurst"), lambda s: s["hurst"]),
        **play("compressibility", ("compressibility",), lambda s: 0.0),
        **play("skewness", ("skew_negative", "gaussian", "skew_positive"), _gamma),
        **play("kurtosis", cutoffs, lambda s: -s["wavelength_short"]),
        **play("moments", ("kurtosis_low", "kurtosis_normal", "kurtosis_high"), _kurtosis),
    }


def _gamma(surface: Mapping[str, Any]) -> float:
    return surface.get("johnson", {}).get("gamma", 0.0)


def _kurtosis(surface: Mapping[str, Any]) -> float:
    return surface.get("moments", {}).get("kurtosis", 3.0)


# Towards the continuum: the same claims on the same surfaces, finer.


def resolutions(surfaces: Mapping[str, Mapping[str, Any]]) -> dict[float, dict[str, str]]:
    """Surfaces that differ in their nodes alone, for two or more Hurst exponents.

    Parameters
    ----------
    surfaces : mapping
        Section of this name of the configuration.

    Returns
    -------
    dict
        Nodes on the shortest wavelength → role → name of a surface, rising; empty without such surfaces.
    """
    families: dict[str, dict[float, str]] = {}
    for name, surface in surfaces.items():
        kind = {key: value for key, value in surface.items() if key not in ("points", "label")}
        nodes = surface["points"] * surface["wavelength_short"]
        families.setdefault(repr(sorted(kind.items())), {})[nodes] = name
    several = sorted(
        (f for f in families.values() if len(f) > 1), key=lambda f: surfaces[next(iter(f.values()))]["hurst"]
    )
    if len(several) < 2 or several[0].keys() != several[-1].keys():
        return {}
    small, large = several[0], several[-1]
    return {
        nodes: {"small_hurst": small[nodes], "large_hurst": large[nodes], "compressibility": large[nodes]}
        for nodes in sorted(small)
    }


class Limit(NamedTuple):
    """A number towards vanishing grid spacing.

    Parameters
    ----------
    values : array
        Mean over seeds at each resolution, coarse to fine.
    limit : float
    error : float
        Of the limit: of the extrapolation, and of the mean over seeds of what it adds to the finest.
    """

    values: Array
    limit: float
    error: float


def extrapolate(nodes: Sequence[float], values: Array) -> Limit:
    """The limit of a number as the grid is refined.

    Parameters
    ----------
    nodes : (resolutions,) rising numbers
        Nodes on the shortest wavelength, each twice the one before.
    values : (seeds, resolutions) array

    Returns
    -------
    Limit
        By Richardson's rule with the order that the last three values show, kept between ½ and 2; with two
        values, or where the changes do not shrink, the order 1. The error of the extrapolation is what it
        adds to the finest value.
    """
    if len(nodes) < 2 or not np.allclose(np.diff(np.log2(nodes)), 1):
        raise ValueError(
            f"nodes = {list(nodes)!r}: two or more numbers, each twice the one before, are needed"
        )
    mean = values.mean(axis=0)
    last = mean[-1] - mean[-2]
    order = 1.0
    before = mean[-2] - mean[-3] if mean.size > 2 else 0.0
    if before and 0 < last / before < 1:
        order = float(np.clip(-np.log2(last / before), 0.5, 2.0))
    gain = 1 / (2**order - 1)
    limit = mean[-1] + gain * last
    spread = 0.0
    if len(values) > 1:
        spread = float((values[:, -1] - values[:, -2]).std(ddof=1) / np.sqrt(len(values)) * gain)
    return Limit(mean, float(limit), float(np.hypot(gain * last, spread)))


def continuum(measure: Measure, finer: Mapping[float, Evidence]) -> Limit:
    """A number towards vanishing grid spacing.

    Parameters
    ----------
    measure : callable
        As of a `Claim`.
    finer : mapping
        Nodes on the shortest wavelength → evidence of the same surfaces on that grid, of `resolutions`.

    Raises
    ------
    MissingEvidenceError
        If the number needs other surfaces, or is not random.
    """
    nodes = sorted(finer)
    if len(nodes) < 2:
        raise MissingEvidenceError("no surfaces that differ in their nodes alone")
    found = [measure(finer[n]) for n in nodes]
    random = [one for one in found if not isinstance(one, Fixed) and np.all(np.isfinite(one))]
    if len(random) < len(nodes):
        raise MissingEvidenceError("nothing that the grid changes")
    return extrapolate(nodes, np.stack(random, axis=1))


# The table.

COLUMNS = (
    "identifier",
    "section",
    "the paper says",
    "measured",
    "predicted",
    "value",
    "standard error",
    "interval low",
    "interval high",
    "seeds",
    "verdict",
    "nodes per shortest wavelength",
    "continuum shift",
    "continuum shift error",
    "missing",
)


_RULE = f"""\
A statement holds if the {100 * CONFIDENCE:g} % interval of the mean over seeds (Student's t, paired by
seed) lies inside the region predicted; it does not hold if the interval lies outside; else this ensemble does
not decide it. One seed decides nothing. Values without seeds are those of closed forms and finite elements,
with their numerical uncertainty. Of twenty intervals of 95 % one is expected to miss the truth.

*Continuum* is what vanishing grid spacing adds to the value: the same statement on the same surfaces in a
smaller cell at 8, 16 and 32 nodes on the shortest wavelength, extrapolated."""


def decide(
    claims: Sequence[Claim], evidence: Evidence, finer: Mapping[float, Evidence] | None = None
) -> list[Finding]:
    """Every claim judged, with the shift of its number towards vanishing grid spacing where it is known.

    Parameters
    ----------
    claims : sequence of Claim
    evidence : Evidence
    finer : mapping, optional
        As of `continuum`. The shift is the limit less the value on the coarsest of these grids, which is to
        have as many nodes on the shortest wavelength as the study.
    """
    findings = []
    for claim in claims:
        finding = judge(claim, evidence)
        try:
            limit = continuum(claim.measure, finer or {})
        except MissingEvidenceError:
            findings.append(finding)
        else:
            shift = limit.limit - float(limit.values[0])
            findings.append(replace(finding, shift=shift, shift_error=limit.error))
    return findings


def rows(findings: Sequence[Finding], nodes: float) -> list[dict[str, Any]]:
    """The findings as rows of `COLUMNS`; `nodes` on the shortest wavelength in the study."""
    return [
        dict(
            zip(
                COLUMNS,
                (
                    f.claim.identifier,
                    f.claim.section,
                    f.claim.sentence,
                    f.claim.quantity,
                    str(f.claim.region),
                    f.value,
                    f.error,
                    f.low,
                    f.high,
                    f.seeds,
                    f.verdict,
                    nodes if f.seeds else "",
                    f.shift,
                    f.shift_error,
                    f.why,
                ),
                strict=True,
            )
        )
        for f in findings
    ]


def tally(findings: Sequence[Finding]) -> dict[str, int]:
    """How many claims have each verdict."""
    return {verdict: sum(f.verdict == verdict for f in findings) for verdict in VERDICTS}


def markdown(findings: Sequence[Finding], seeds: Sequence[int], nodes: float) -> str:
    """The findings for a reader: what was done, the tally, and a table for each section of the paper."""
    counts = ", ".join(f"{count} {verdict}" for verdict, count in tally(findings).items() if count)
    lines = [
        "# Does the paper hold?",
        "",
        f"{len(findings)} statements: {counts}.",
        "",
        f"Seeds {', '.join(map(str, seeds))}; {nodes:g} nodes on the shortest wavelength; "
        f"asperity {asperity.__version__}.",
        "",
        _RULE,
    ]
    head = "| the paper says | measured | predicted | value | verdict | continuum |"
    groups: dict[str, list[Finding]] = {}
    for finding in findings:
        first = finding.claim.section.split(", ")
        groups.setdefault(next((s for s in first if s[0].isdigit()), first[0]), []).append(finding)
    for section in sorted(groups):
        lines += ["", f"## Section {section}", "", head, "|---|---|---|---|---|---|"]
        for f in groups[section]:
            verdict = f"**{f.verdict}**" + (f" ({f.why})" if f.why else "")
            cells = (f.claim.sentence, f.claim.quantity, str(f.claim.region))
            found = with_error(f.value, f.error), verdict, with_error(f.shift, f.shift_error, signed=True)
            lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in (*cells, *found)) + " |")
    return "\n".join(lines) + "\n"


def continuum_markdown(headlines: Mapping[str, Measure], finer: Mapping[float, Evidence]) -> str:
    """Headline numbers on finer and finer grids and their limits, as a table; empty without such grids."""
    if len(finer) < 2:
        return ""
    nodes = sorted(finer)
    lines = ["", "## Towards the continuum", ""]
    lines.append("| | " + " | ".join(f"{n:g} nodes" for n in nodes) + " | limit |")
    lines.append("|---|" + "---|" * (len(nodes) + 1))
    for name, measure in headlines.items():
        found = continuum(measure, finer)
        cells = [name, *(f"{value:.4g}" for value in found.values), with_error(found.limit, found.error)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def with_error(value: float, error: float, signed: bool = False) -> str:
    """A number with its error to two digits: ``1.445 ± 0.012``; three digits where there is no error."""
    if np.isnan(value):
        return ""
    sign = "+" if signed else ""
    if np.isnan(error) or error == 0:
        return f"{value:{sign}.3g}"
    digits = min(max(0, 1 - int(np.floor(np.log10(error)))), 12)
    return f"{value:{sign}.{digits}f} ± {error:.{digits}f}"

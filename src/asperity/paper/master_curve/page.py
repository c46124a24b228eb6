"""What docs/master_curve.md says: the scatter of every scale, the dependence on ν, and the verdict."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd

from asperity.paper.claims.report import with_error
from asperity.paper.master_curve.analysis import (
    COLLAPSED,
    DEPTH_SCALES,
    HEIGHT_SCALES,
    REFERENCE,
    exponents,
    hertz_peak,
    of_poisson,
    scatter,
)
from asperity.results import markup

INPUTS = ("ln A", "H", "ln λ_l/λ_s")
"""Terms of the fit in what is known before the contact is computed."""

BEST_HEIGHT = "height_gradient_contact"


def best(rows: pd.DataFrame, scales: Mapping[str, str]) -> str:
    """Scale with the smallest scatter."""
    return min(scales, key=lambda key: scatter(rows, key).value)


def _percent(value: float, error: float) -> str:
    return with_error(100 * value, 100 * error) + " %"


def _scales(rows: pd.DataFrame) -> str:
    lines = [["number", "scale", "scatter", "exponent of A", "scatter with it"]]
    for number, scales in (("height", HEIGHT_SCALES), ("depth", DEPTH_SCALES)):
        for key, text in scales.items():
            power = exponents(rows, key, ["ln A"])["ln A"]
            lines.append(
                [
                    number,
                    text,
                    _percent(*scatter(rows, key)),
                    with_error(*power, signed=True),
                    _percent(*scatter(rows, key, ["ln A"])),
                ]
            )
    return markup.markdown(lines)


def _of_poisson(rows: pd.DataFrame) -> str:
    height, depth = best(rows, HEIGHT_SCALES), best(rows, DEPTH_SCALES)
    heights, depths = of_poisson(rows, height), of_poisson(rows, depth)
    own = hertz_peak(REFERENCE)
    names = [HEIGHT_SCALES[height].split(",")[0], DEPTH_SCALES[depth].split(",")[0]]
    head = ["ν", f"height over {names[0]}", f"over that at ν = {REFERENCE:g}", "Hertz"]
    lines = [[*head, f"depth over {names[1]}", f"over that at ν = {REFERENCE:g}", "Hertz"]]
    for nu in heights:
        hertz = hertz_peak(nu)
        lines.append(
            [
                f"{nu:g}",
                with_error(*heights[nu]),
                f"{heights[nu].value / heights[REFERENCE].value:.3f}",
                f"{hertz[0] / own[0]:.3f}",
                with_error(*depths[nu]),
                f"{depths[nu].value / depths[REFERENCE].value:.3f}",
                f"{hertz[1] / own[1]:.3f}",
            ]
        )
    return markup.markdown(lines)


def _inputs(rows: pd.DataFrame) -> str:
    """Fit of the depth over λ_s and of the height in what is known before the contact is computed."""
    plain = rows[~rows["skewed"]]
    parts = []
    for key, text in ((BEST_HEIGHT, "height over E\\*ḡ_r"), ("depth_wavelength", "depth over λ_s")):
        slopes = exponents(plain, key, INPUTS)
        told = ", ".join(f"{name}: {with_error(*one, signed=True)}" for name, one in slopes.items())
        parts.append(f"{text}: {told}, scatter {_percent(*scatter(plain, key, INPUTS))}")
    return "Slopes of the logarithm, Gaussian surfaces: " + "; ".join(parts) + "."


def verdict(rows: pd.DataFrame) -> str:
    """One paragraph: whether height and depth lie on one curve."""
    parts, collapsed = [], []
    for name, scales in (("height", HEIGHT_SCALES), ("depth", DEPTH_SCALES)):
        key = best(rows, scales)
        found, scale = scatter(rows, key), scales[key]
        own = of_poisson(rows, key)[REFERENCE]
        collapsed.append(found.value + found.error <= COLLAPSED)
        worst = max(scales, key=lambda other: scatter(rows, other).value)
        parts.append(
            f"the {name} is {with_error(*own)} times {scale} at ν = {REFERENCE:g}, with a scatter of "
            f"{_percent(*found)} (worst: {scales[worst]}, {_percent(*scatter(rows, worst))})"
        )
    limit = f"{100 * COLLAPSED:g} %"
    start = {
        (True, True): f"**There is one curve for both, within {limit}**",
        (True, False): f"**There is one curve for the height within {limit}, but not for the depth**",
        (False, True): f"**There is one curve for the depth within {limit}, but not for the height**",
        (False, False): f"**There is no curve for all surfaces within {limit}**",
    }[collapsed[0], collapsed[1]]
    surfaces, areas = rows["surface"].nunique(), sorted(rows["area"].round(2).unique())
    return (
        f"{start}: {'; '.join(parts)}; {surfaces} surfaces, A from {areas[0]:g} to {areas[-1]:g}, and one "
        f"factor for each Poisson's ratio."
    )


def sections(rows: pd.DataFrame) -> dict[str, str]:
    """Generated sections of the page by the name of their marks."""
    return {
        "verdict": verdict(rows),
        "scales": _scales(rows),
        "poisson": _of_poisson(rows) + "\n\n" + _inputs(rows),
    }

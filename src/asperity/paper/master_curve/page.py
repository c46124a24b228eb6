"""What docs/master_curve.md says: the scatter of every scale, the dependence on ν, and the verdict."""

from __future__ import annotations

import pandas as pd

from asperity import markup
from asperity.paper.claims.report import with_error
from asperity.paper.master_curve.analysis import (
    COLLAPSED,
    DEPTH_SCALES,
    HEIGHT_SCALES,
    REFERENCE,
    exponents,
    held_out,
    hertz_peak,
    of_poisson,
    scatter,
)

INPUTS = ("ln A", "H", "ln λ_l/λ_s")
"""Terms of the fit in what is known before the contact is computed."""

WAVELENGTH = "depth_wavelength"

LENGTHS = tuple(key for key in DEPTH_SCALES if key != WAVELENGTH)
"""Lengths ℓ of the contact."""


def best_height(rows: pd.DataFrame) -> str:
    """Scale of the height with the smallest scatter."""
    return min(HEIGHT_SCALES, key=lambda key: scatter(rows, key).value)


def best_length(rows: pd.DataFrame) -> str:
    """Length ℓ with the smallest scatter of the depth over λ_s around a power of ℓ/λ_s."""
    return min(LENGTHS, key=lambda key: scatter(rows, WAVELENGTH, [f"ln {key}"]).value)


def _percent(value: float, error: float) -> str:
    return with_error(100 * value, 100 * error) + " %"


def _scales(rows: pd.DataFrame) -> str:
    head = [
        "number",
        "scale s",
        "scatter over s",
        "exponent b",
        "scatter",
        "predicted for a surface left out",
    ]
    lines = [[*head[:3], "fitted beside", *head[3:]]]
    fits = [("height", key, key, "ln A", "A^b") for key in HEIGHT_SCALES]
    fits += [("depth", key, WAVELENGTH, f"ln {key}", "λ_s (s/λ_s)^b") for key in LENGTHS]
    fits.append(("depth", WAVELENGTH, WAVELENGTH, "ln A", "A^b"))
    for number, key, over, term, form in fits:
        lines.append(
            [
                number,
                {**HEIGHT_SCALES, **DEPTH_SCALES}[key],
                _percent(*scatter(rows, key)),
                form,
                with_error(*exponents(rows, over, [term])[term], signed=True),
                _percent(*scatter(rows, over, [term])),
                f"{100 * held_out(rows, over, [term]):.1f} %",
            ]
        )
    return markup.markdown(pd.DataFrame(lines[1:], columns=lines[0]))


def _of_poisson(rows: pd.DataFrame) -> str:
    height, depth = best_height(rows), best_length(rows)
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
    return markup.markdown(pd.DataFrame(lines[1:], columns=lines[0]))


def _inputs(rows: pd.DataFrame) -> str:
    """Fit of the depth over λ_s and of the height in what is known before the contact is computed."""
    plain = rows[~rows["skewed"]]
    parts = []
    for key, text in (
        ("height_gradient_contact", "height over E\\*ḡ_r"),
        ("depth_wavelength", "depth over λ_s"),
    ):
        slopes = exponents(plain, key, INPUTS)
        told = ", ".join(f"{name}: {with_error(*one, signed=True)}" for name, one in slopes.items())
        parts.append(f"{text}: {told}, scatter {_percent(*scatter(plain, key, INPUTS))}")
    return "Slopes of the logarithm, Gaussian surfaces: " + "; ".join(parts) + "."


def verdict(rows: pd.DataFrame) -> str:
    """One paragraph: whether height and depth lie on one curve."""
    height, length = best_height(rows), best_length(rows)
    of_height, of_depth = scatter(rows, height), scatter(rows, WAVELENGTH, [f"ln {length}"])
    one_curve = [found.value + found.error <= COLLAPSED for found in (of_height, of_depth)]
    limit = f"{100 * COLLAPSED:g} %"
    start = {
        (True, True): f"**Height and depth lie on one curve each, within {limit}**",
        (True, False): f"**The height lies on one curve within {limit}, the depth does not**",
        (False, True): f"**The depth lies on one curve within {limit}, the height does not**",
        (False, False): f"**Neither height nor depth lies on one curve within {limit}**",
    }[one_curve[0], one_curve[1]]
    power = exponents(rows, WAVELENGTH, [f"ln {length}"])[f"ln {length}"]
    areas = sorted(rows["area"].round(2).unique())
    return (
        f"{start} ({rows['surface'].nunique()} surfaces, A from {areas[0]:g} to {areas[-1]:g}, one factor "
        f"for each ν). The depth is d = C(ν) λ_s (ℓ/λ_s)^b with b = {with_error(*power)} and ℓ = "
        f"{DEPTH_SCALES[length]}: scatter {_percent(*of_depth)}, "
        f"{100 * held_out(rows, WAVELENGTH, [f'ln {length}']):.1f} % for a surface left out of the fit. The "
        f"height is best divided by {HEIGHT_SCALES[height]}: "
        f"{with_error(*of_poisson(rows, height)[REFERENCE])} at "
        f"ν = {REFERENCE:g}, scatter {_percent(*of_height)}, {100 * held_out(rows, height, []):.1f} % for a "
        f"surface left out."
    )


def sections(rows: pd.DataFrame) -> dict[str, str]:
    """Generated sections of the page by the name of their marks."""
    return {
        "verdict": verdict(rows),
        "scales": _scales(rows),
        "poisson": _of_poisson(rows) + "\n\n" + _inputs(rows),
    }

"""Effects of skewness and kurtosis of the heights at one spectrum: writes docs/height_distribution.md.

    python studies/height_distribution/height_distribution.py studies/height_distribution/config.yaml

computes the surfaces that are missing in the folder of results, then the table docs/height_distribution.csv.
Without a configuration figure and page are written from the table that is kept. Run it in the project's
folder.

Every surface has the waves of one Gaussian surface of its seed, so that seeds are compared in pairs: a change
is the mean of the logarithmic ratios over seeds, and its error that over seeds and those of the grid.
"""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
import yaml
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.special import ndtri

import asperity as asp
from asperity.core.markup import with_error
from asperity.study.small_studies import computed_once, rendered
from asperity.surface.heights import ShapedSurface
from asperity.views.style import panels, save, style

KEPT = Path("docs/height_distribution.csv")

NUMBERS = {
    "kappa": "κ = a_r E\\*ḡ/p̄",
    "kappa_contact": "κ_r = a_r E\\*ḡ_r/p̄",
    "gradient_contact": "ḡ_r/ḡ",
    "p90": "90 % peak / E\\*ḡ",
    "p99": "99 % peak / E\\*ḡ",
    "p99_contact": "99 % peak / E\\*ḡ_r",
    "depth": "depth / λ_s",
}
"""Column of the table → number on the page. The gradient ḡ is that of the Gaussian surface, which
all surfaces of one spectrum share."""

GAUSSIAN = "gaussian"


def shaped(gaussian: np.ndarray, distribution: Mapping[str, Any]) -> tuple[np.ndarray, float]:
    """Heights of a case, and the residual of their distribution."""
    if "johnson" in distribution:
        return asp.surface.johnson(gaussian, **distribution["johnson"]), 0.0
    if "moments" in distribution:
        found = asp.surface.with_heights(gaussian, moments=distribution["moments"])
        return found.height, found.heights_residual
    return gaussian, 0.0


def numbers_of(config: Mapping[str, Any], distribution: Mapping[str, Any], seed: int) -> xr.Dataset:
    """Numbers of one surface and seed under the area, with estimates at vanishing grid spacing."""
    points, band = config["points"], config["spectrum"]
    gaussian = asp.self_affine((points, points), seed=seed, **band)
    height, residual = shaped(gaussian, distribution)
    reference, own = (asp.roughness_parameters(each) for each in (gaussian, height))
    contact = asp.solve_contact(
        height, asp.Solid(1.0, config["poisson"]), area_fraction=config["area_fraction"]
    )
    stress = asp.analyse_stress(contact, quantities=("von_mises", "pressure"))
    found = asp.continuum_limit(contact, stress).sel(quantity="von_mises").squeeze("poisson", drop=True)
    best, error = (found.sel(kind=kind, drop=True) for kind in ("estimate", "error"))
    load = contact.mean_pressure / contact.solid.effective_modulus
    unit = contact.solid.effective_modulus * reference.rms_gradient
    ratio = best["gradient_rms_contact"] / reference.rms_gradient
    numbers = {
        "kappa": best["area_fraction"] * reference.rms_gradient / load,
        "kappa_contact": best["proportionality"],
        "gradient_contact": ratio,
        "p90": best["p90"] / unit,
        "p99": best["p99"] / unit,
        "p99_contact": best["p99"] / unit / ratio,
        "depth": best["mean_depth_highest"] / band["wavelength_short"],
    }
    errors = {
        "kappa": error["area_fraction"],
        "kappa_contact": error["proportionality"],
        "gradient_contact": error["gradient_rms_contact"],
        "p90": error["p90"],
        "p99": error["p99"],
        "p99_contact": np.hypot(error["p99"], error["gradient_rms_contact"]),
        "depth": error["mean_depth_highest"],
    }
    of_surface = {
        "skewness": own.skewness,
        "kurtosis": own.kurtosis,
        "gradient": own.rms_gradient / reference.rms_gradient,
        "residual": residual,
        "load": load / reference.rms_gradient,
        "certificate": contact.certificate.worst,
    }
    grid = {f"{name}_grid": abs(value) for name, value in errors.items()}
    return xr.Dataset({**of_surface, **numbers, **grid}).drop_vars("quantity", errors="ignore")


def table(config: Mapping[str, Any]) -> pd.DataFrame:
    """A row for each case and seed."""
    frames = []
    for name, case in config["cases"].items():
        found = computed_once(
            Path(config["results"], f"{name}.nc"),
            [config, name],
            lambda case=case: xr.concat(
                [numbers_of(config, case, seed) for seed in config["seeds"]],
                xr.Variable("seed", config["seeds"]),
            ),
        )
        frames.append(found.to_dataframe().reset_index().assign(case=name))
    return pd.concat(frames)


def change(rows: pd.DataFrame, key: str, case: str, other: str = GAUSSIAN) -> tuple[float, float]:
    """Logarithm of the ratio of a number in two cases, and its error over seeds and of the grid."""
    one, two = (rows[rows["case"] == name].set_index("seed") for name in (case, other))
    ratio = np.log(one[key] / two[key])
    grid = [float(each[f"{key}_grid"].mean()) for each in (one, two)]
    return float(ratio.mean()), float(np.hypot(ratio.std(ddof=1) / np.sqrt(ratio.size), np.hypot(*grid)))


def draw(rows: pd.DataFrame, config: Mapping[str, Any]) -> Figure:
    """Numbers by skewness and kurtosis, heights wanted and reached, and the surfaces of section 5.4."""
    figure, (by_skewness, by_kurtosis, heights, parts) = panels(2, 2, height=75.0)
    labels = {
        "kappa": r"$\kappa$",
        "kappa_contact": r"$\kappa_r$",
        "gradient_contact": r"$\bar{g}_r$",
        "p99": r"99 % peak / $E^*\bar{g}$",
        "p99_contact": r"99 % peak / $E^*\bar{g}_r$",
        "depth": "depth",
    }
    for axis, along in ((by_skewness, "skewness"), (by_kurtosis, "kurtosis")):
        means = rows.groupby("case")[along].mean()
        names = [name for name in means.index if name.startswith(along)]
        some = means[[*names, *(["kurtosis_4"] if along == "skewness" else [])]].sort_values()
        for number, (key, label) in enumerate(labels.items()):
            ratios = [_ratio(rows, key, name) for name in some.index]
            look = {"marker": "o", "ms": 3, "lw": 1, "color": f"C{number}", "label": label}
            axis.errorbar(some, *zip(*ratios, strict=True), **look)
        axis.set(xlabel=f"{along} of the lower face")
        _ratios(axis)
    by_skewness.legend(fontsize="x-small")
    _draw_heights(heights, config)
    for number, key in enumerate(shown := ("kappa", "gradient_contact", "p99", "p99_contact", "depth")):
        for sign, colour, shift in (("plus", "C3", -0.15), ("minus", "C0", 0.15)):
            for made, marker, face in ((f"johnson_{sign}", "s", "none"), (f"moments_{sign}", "o", colour)):
                look = {"marker": marker, "mfc": face, "color": colour, "ms": 4, "lw": 1}
                parts.errorbar(number + shift, *_ratio(rows, key, made), **look)
    parts.set_xticks(range(5), [labels[key].replace(" / ", "\n/ ") for key in shown], fontsize="x-small")
    _ratios(parts)
    for colour, name in (("C3", "+1.25"), ("C0", "−1.25")):
        parts.plot([], [], "s", color=colour, mfc="none", ms=4, label=rf"$\gamma$ = {name}")
        parts.plot([], [], "o", color=colour, ms=4, label="same moments, one spectrum")
    parts.legend(fontsize="x-small")
    return figure


def _ratio(rows: pd.DataFrame, key: str, case: str) -> tuple[float, float]:
    """A number over that of the Gaussian surfaces, and its error."""
    value, error = change(rows, key, case)
    return np.exp(value), np.exp(value) * error


def _ratios(axis: Axes) -> None:
    """Logarithmic axis of ratios to the Gaussian surface."""
    axis.axhline(1, color="0.6", lw=0.6)
    axis.set(yscale="log", ylim=(0.25, 4), ylabel="over that of the Gaussian surface")
    axis.set_yticks([0.25, 0.5, 0.7, 1, 1.5, 2, 3], ["0.25", "0.5", "0.7", "1", "1.5", "2", "3"])
    axis.set_yticks([], minor=True)


def _draw_heights(axis: Axes, config: Mapping[str, Any]) -> None:
    """Density of the heights of the first seed: those asked for (broken lines), and those reached."""
    points, band = config["points"], config["spectrum"]
    gaussian = asp.self_affine((points, points), seed=config["seeds"][0], **band)
    normal = ndtri((np.arange(points**2) + 0.5) / points**2)[None]
    bins = np.linspace(-4, 4, 81)
    for number, name in enumerate(("kurtosis_22", "skewness_plus_10", "kurtosis_6")):
        moments = config["cases"][name]["moments"]
        reached = asp.surface.with_heights(gaussian, moments=moments).height / band["rms_height"]
        wanted = asp.surface.with_moments(normal, *moments)
        for values, look in ((wanted, "--"), (reached, "-")):
            density, _ = np.histogram(values, bins, density=True)
            label = f"{moments[0]:g}, {moments[1]:g}" if look == "-" else None
            axis.plot((bins[1:] + bins[:-1]) / 2, density, look, color=f"C{number}", lw=1, label=label)
    axis.set(yscale="log", ylim=(1e-4, 1), xlabel="height / rms height", ylabel="probability density")
    axis.legend(title="skewness, kurtosis", fontsize="x-small")


def residuals(config: Mapping[str, Any]) -> dict[str, ShapedSurface]:
    """Surfaces of the first seed with six distributions, one of them that of a given sample."""
    points, band = config["points"], config["spectrum"]
    gaussian = asp.self_affine((points, points), seed=config["seeds"][0], **band)
    cases: dict[str, dict[str, Any]] = {
        f"skewness {s:g}, kurtosis {k:g}": {"moments": (s, k)}
        for s, k in ((1, 4), (-0.5, 4), (0, 2.2), (0, 6))
    }
    cases["honed, Rpq/Rvq = 0.25, Rmq = 80 %"] = {"plateau": (0.1, 0.4, 80)}
    cases["sample of uniform heights, squared"] = {"sample": np.linspace(0, 1, 1001) ** 2}
    return {name: asp.surface.with_heights(gaussian, **case) for name, case in cases.items()}


def page(rows: pd.DataFrame, config: Mapping[str, Any]) -> str:
    """The page docs/height_distribution.md, from its template."""
    share = change(rows, "p99", "moments_plus", "moments_minus")[0]
    share /= change(rows, "p99", "johnson_plus", "johnson_minus")[0]
    means = (
        rows.groupby("case", sort=False)
        .mean()
        .assign(residual=rows.groupby("case")["residual"].max(), certificate=rows["certificate"].max())
    )
    return rendered(
        Path(__file__).with_name("page.md.j2"),
        {"percent": lambda found: f"{with_error(*_percent(*found), signed=True)} %"},
        rows=means,
        config=config,
        numbers=NUMBERS,
        share=share,
        residuals=residuals(config),
        change=lambda key, case, other=GAUSSIAN: change(rows, key, case, other),
    )


def _percent(value: float, error: float) -> tuple[float, float]:
    """Change in per cent of a logarithm of a ratio, and its error."""
    return 100 * float(np.expm1(value)), 100 * float(np.exp(value)) * error


def main() -> None:
    """Write table, figure and page."""
    if sys.argv[1:]:
        config = yaml.safe_load(Path(sys.argv[1]).read_text(encoding="utf-8"))
        table(config).to_csv(KEPT, index=False, float_format="%.6g")
    config = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text(encoding="utf-8"))
    rows = pd.read_csv(KEPT)
    with style():
        save(draw(rows, config), KEPT.with_suffix(".png"))
    KEPT.with_suffix(".md").write_text(page(rows, config), encoding="utf-8")


if __name__ == "__main__":
    main()

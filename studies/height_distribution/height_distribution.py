"""Effects of skewness and kurtosis of the heights at one spectrum: writes README.md beside it.

    python studies/height_distribution/height_distribution.py studies/height_distribution/config.yaml

computes the surfaces that are missing in the folder of results, then the table height_distribution.csv.
Without a configuration figure and page are written from the table that is kept. Run it in the project's
folder.

Every surface has the waves of one Gaussian surface of its seed, so that seeds are compared in pairs: a change
is the mean of the logarithmic ratios over seeds, and its error contains the scatter over seeds and the errors
of the grid.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
import yaml
from matplotlib.figure import Figure

import asperity as asp
from asperity.core.markup import markdown, with_error
from asperity.study.small_studies import computed_once, rendered, write_study
from asperity.views.style import panels

CONFIG = yaml.safe_load(Path(__file__).with_name("config.yaml").read_text(encoding="utf-8"))

STATEMENTS = (
    ("the gradient of the contact is lower for positive skewness", "gradient_contact", -1),
    ("peaks over E\\*ḡ_r are larger for positive skewness", "p99_contact", 1),
    ("peaks that are not divided by the gradient are smallest for positive skewness", "p99", -1),
    ("a larger kurtosis has the larger peaks", "p99", 1),
    ("the high peaks are nearer to the surface for a larger kurtosis", "depth", -1),
)
"""Statements of section 5.4, the number that decides each, and the sign of its change; the last two, of the
kurtosis, are made with λ_s in the paper."""

GAUSSIAN = "gaussian"


def shaped(gaussian: np.ndarray, distribution: Mapping[str, Any]) -> np.ndarray:
    """Heights of a case."""
    if "johnson" in distribution:
        return asp.surface.johnson(gaussian, **distribution["johnson"])
    if "moments" in distribution:
        return asp.surface.with_heights(gaussian, moments=distribution["moments"]).height
    return gaussian


def numbers_of(config: Mapping[str, Any], distribution: Mapping[str, Any], seed: int) -> xr.Dataset:
    """Numbers of one surface and seed under the area, with estimates at zero grid spacing."""
    points, band = config["points"], config["spectrum"]
    gaussian = asp.self_affine((points, points), seed=seed, **band)
    height = shaped(gaussian, distribution)
    reference, own = (asp.roughness_parameters(each) for each in (gaussian, height))
    contact = asp.solve_contact(
        height, asp.Solid(1.0, config["poisson"]), contact_area_fraction=config["contact_area_fraction"]
    )
    stress = asp.analyse_stress(contact, quantities=("von_mises", "pressure"))
    found = asp.continuum_limit(contact, stress).sel(quantity="von_mises").squeeze("poisson", drop=True)
    best, error = (found.sel(kind=kind, drop=True) for kind in ("estimate", "error"))
    load = contact.mean_pressure / contact.solid.effective_modulus
    unit = contact.solid.effective_modulus * reference.rms_gradient
    ratio = best["gradient_rms_contact"] / reference.rms_gradient
    both = np.hypot(error["p99"], error["gradient_rms_contact"])
    numbers_and_errors = {
        "kappa": (
            best["contact_area_fraction"] * reference.rms_gradient / load,
            error["contact_area_fraction"],
        ),
        "kappa_contact": (best["proportionality"], error["proportionality"]),
        "gradient_contact": (ratio, error["gradient_rms_contact"]),
        "p90": (best["p90"] / unit, error["p90"]),
        "p99": (best["p99"] / unit, error["p99"]),
        "p99_contact": (best["p99"] / unit / ratio, both),
        "depth": (best["mean_depth_highest"] / band["wavelength_short"], error["mean_depth_highest"]),
    }
    numbers = {name: number for name, (number, _) in numbers_and_errors.items()}
    of_surface = {
        "skewness": own.skewness,
        "kurtosis": own.kurtosis,
        "gradient": own.rms_gradient / reference.rms_gradient,
        "load": load / reference.rms_gradient,
        "certificate": contact.certificate.worst,
    }
    grid = {f"{name}_grid": abs(value) for name, (_, value) in numbers_and_errors.items()}
    return xr.Dataset({**of_surface, **numbers, **grid}).drop_vars("quantity", errors="ignore")


def numbers_of_seeds(config: Mapping[str, Any], distribution: Mapping[str, Any]) -> xr.Dataset:
    """Numbers of all seeds of a case."""
    seeds = [numbers_of(config, distribution, seed) for seed in config["seeds"]]
    return xr.concat(seeds, xr.Variable("seed", config["seeds"]))


def table(config: Mapping[str, Any]) -> pd.DataFrame:
    """A row for each case and seed."""
    frames = []
    for name, case in config["cases"].items():
        path = Path(config["results"], f"{name}.nc")
        found = computed_once(path, [config, name], numbers_of_seeds, config, case)
        frames.append(found.to_dataframe().reset_index().assign(case=name))
    return pd.concat(frames)


def change(rows: pd.DataFrame, key: str, case: str, other: str = GAUSSIAN) -> tuple[float, float]:
    """Logarithm of the ratio of a number in two cases, and its error over seeds and of the grid."""
    one, two = (rows[rows["case"] == name].set_index("seed") for name in (case, other))
    ratio = np.log(one[key] / two[key])
    grid = [float(each[f"{key}_grid"].mean()) for each in (one, two)]
    return float(ratio.mean()), float(np.hypot(ratio.std(ddof=1) / np.sqrt(ratio.size), np.hypot(*grid)))


def draw(rows: pd.DataFrame) -> Figure:
    """Numbers by skewness and by kurtosis, over the numbers of the Gaussian surfaces."""
    figure, axes = panels(2, 1, height=75.0)
    labels = {
        "kappa": r"$\kappa$",
        "kappa_contact": r"$\kappa_r$",
        "gradient_contact": r"$\bar{g}_r$",
        "p99": r"99 % peak / $E^*\bar{g}$",
        "p99_contact": r"99 % peak / $E^*\bar{g}_r$",
        "depth": "depth",
    }
    for axis, along in zip(axes, ("skewness", "kurtosis"), strict=True):
        means = rows.groupby("case")[along].mean()
        names = [name for name in means.index if name.startswith(along)]
        some = means[[*names, *(["kurtosis_4"] if along == "skewness" else [])]].sort_values()
        for number, (key, label) in enumerate(labels.items()):
            found = np.array([change(rows, key, name) for name in some.index])
            value, error = np.exp(found[:, 0]), np.exp(found[:, 0]) * found[:, 1]
            axis.errorbar(some, value, error, fmt="o-", ms=3, lw=1, color=f"C{number}", label=label)
        axis.axhline(1, color="0.6", lw=0.6)
        axis.set(yscale="log", ylim=(0.25, 4), xlabel=f"{along} of the lower face")
        axis.set_yticks([0.25, 0.5, 0.7, 1, 1.5, 2, 3], ["0.25", "0.5", "0.7", "1", "1.5", "2", "3"])
        axis.set_yticks([], minor=True)
    axes[0].set_ylabel("over that of the Gaussian surface")
    axes[0].legend(fontsize="x-small")
    return figure


def percent(found: tuple[float, float]) -> str:
    """A logarithm of a ratio and its error as a change in per cent."""
    value, error = found
    return f"{with_error(100 * np.expm1(value), 100 * np.exp(value) * error, signed=True)} %"


def statements(rows: pd.DataFrame) -> pd.DataFrame:
    """Statements of section 5.4: their number on the paper's surfaces and at one spectrum, and a verdict."""
    found = []
    for sentence, key, sign in STATEMENTS:
        of_kurtosis = "kurtosis" in sentence
        pair = ("kurtosis_6", "kurtosis_22") if of_kurtosis else ("skewness_plus_10", "skewness_minus_10")
        value, error = change(rows, key, *pair)
        verdict = "holds" if value * sign > 0 else "does not hold"
        paper = "" if of_kurtosis else percent(change(rows, key, "johnson_plus", "johnson_minus"))
        own = percent((value, error))
        found.append((sentence, paper, own, "not decided" if abs(value) < 2 * error else verdict))
    columns = [
        "section 5.4 says",
        "the paper's surfaces, γ = +1.25 against −1.25",
        "one spectrum, skewness +1 against −1 or kurtosis 6 against 2.2",
        "at one spectrum it",
    ]
    return pd.DataFrame(found, columns=columns)


def page(rows: pd.DataFrame) -> str:
    """The page README.md beside this file, from its template."""
    share = change(rows, "p99", "moments_plus", "moments_minus")[0]
    share /= change(rows, "p99", "johnson_plus", "johnson_minus")[0]
    return rendered(
        Path(__file__).with_name("page.md.j2"),
        config=CONFIG,
        share=share,
        table=markdown(statements(rows)),
        change=lambda *of: percent(change(rows, *of)),
    )


if __name__ == "__main__":
    write_study("height_distribution", table, draw, page)

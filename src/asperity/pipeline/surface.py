"""Stage one: a rough surface, made or measured, and its measures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from asperity.spectral import Fourier, Grid
from asperity.surface.measured import edge_step, make_periodic, read_map
from asperity.surface.roughness import (
    johnson,
    roughness_parameters,
    self_affine,
    spectrum,
    target_spectrum,
    with_moments,
)
from asperity.types import Array

_MAP_KEYS = ("physical_size", "height_factor")
_PERIOD_KEYS = ("detrend", "periodic", "undefined", "wavelength_short", "points")


def make_surface(parameters: Mapping[str, Any], seed: int) -> xr.Dataset:
    """The surface of one entry of the configuration and one seed.

    Parameters
    ----------
    parameters : mapping
        An entry of ``surfaces``: hurst, wavelength_long, wavelength_short, rms_height, points, and
        optionally johnson or moments.
    seed : int

    Returns
    -------
    dataset
        Height, moments, and the spectrum beside the one asked for, which is that of the Gaussian
        surface. Where a transform follows: the spectrum before it; else the standard errors of
        skewness and kurtosis.
    """
    grid = Grid((parameters["points"], parameters["points"]))
    band = {name: parameters[name] for name in ("hurst", "wavelength_long", "wavelength_short", "rms_height")}
    gaussian = height = self_affine(grid.shape, seed=seed, **band)
    if "johnson" in parameters:
        height = johnson(height, **parameters["johnson"])
    elif "moments" in parameters:
        height = with_moments(height, **parameters["moments"])
    dataset = _measured_dataset(height, grid)
    dataset["spectrum_target"] = ("wavenumber", target_spectrum(grid, **band)[1])
    if height is gaussian:
        dataset["skewness_error"], dataset["kurtosis_error"] = moment_errors(grid, **band)
    else:
        dataset["spectrum_before"] = ("wavenumber", spectrum(gaussian)[1])
    return dataset


def read_surface(parameters: Mapping[str, Any]) -> xr.Dataset:
    """The surface of one entry of the configuration's section ``measured``.

    Parameters
    ----------
    parameters : mapping
        file, detrend, and optionally physical_size, height_factor, periodic, undefined,
        wavelength_short, points.

    Returns
    -------
    dataset
        Height, moments and spectrum; the attributes say what was kept: the shortest wavelength, and how
        rough the seam of the period is.
    """
    surface = read_map(
        parameters["file"], **{name: parameters[name] for name in _MAP_KEYS if name in parameters}
    )
    kept = make_periodic(surface, **{name: parameters[name] for name in _PERIOD_KEYS if name in parameters})
    return _measured_dataset(kept.height, kept.grid).assign_attrs(
        wavelength_short=kept.wavelength_short, edge_step=edge_step(kept.height)
    )


def moment_errors(
    grid: Grid, hurst: float, wavelength_long: float, wavelength_short: float, rms_height: float
) -> tuple[float, float]:
    """Standard errors of the skewness and the kurtosis of one sample of a Gaussian surface.

    √(6 ⟨ρ³⟩) and √(24 ⟨ρ⁴⟩), ρ the surface's autocorrelation, averaged over the cell: the variances of the
    means of the third and fourth Hermite polynomial of a Gaussian field, exact to first order.
    """
    wavenumber, power = target_spectrum(grid, hurst, wavelength_long, wavelength_short, rms_height)
    width = wavenumber[0]
    ring = np.rint(grid.wavenumber() / width).astype(int)
    spread: Array = np.zeros(max(ring.max() + 1, power.size + 1))
    spread[np.rint(wavenumber / width).astype(int)] = power
    correlation = Fourier(grid).inverse(spread[ring].astype(complex), overwrite=True)
    correlation /= correlation[0, 0]
    return float(np.sqrt(6 * abs(np.mean(correlation**3)))), float(np.sqrt(24 * np.mean(correlation**4)))


def _measured_dataset(height: Array, grid: Grid) -> xr.Dataset:
    """A surface with its moments and its spectrum."""
    measured = roughness_parameters(height, grid.length)
    wavenumber, power = spectrum(height, grid.length)
    y, x = grid.coordinates()
    return xr.Dataset(
        {
            "height": (("y", "x"), height),
            "rms_height": measured.rms_height,
            "rms_gradient": measured.rms_gradient,
            "skewness": measured.skewness,
            "kurtosis": measured.kurtosis,
            "spectrum": ("wavenumber", power),
        },
        coords={"y": y, "x": x, "wavenumber": wavenumber},
    )

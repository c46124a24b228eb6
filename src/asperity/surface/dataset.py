"""A surface as a dataset of xarray, named as in result files of stage surface."""

from __future__ import annotations

import xarray as xr

from asperity.spectral import Grid
from asperity.surface.roughness import roughness_parameters, spectrum
from asperity.types import Array


def surface_dataset(height: Array, grid: Grid) -> xr.Dataset:
    """Heights over y and x, with their roughness parameters and their spectrum."""
    roughness = roughness_parameters(height, grid.length)
    wavenumber, power = spectrum(height, grid.length)
    y, x = grid.coordinates()
    return xr.Dataset(
        {
            "height": (("y", "x"), height),
            "rms_height": roughness.rms_height,
            "rms_gradient": roughness.rms_gradient,
            "skewness": roughness.skewness,
            "kurtosis": roughness.kurtosis,
            "spectrum": ("wavenumber", power),
        },
        coords={"y": y, "x": x, "wavenumber": wavenumber},
    )

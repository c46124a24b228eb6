"""Stage surface: a random or measured rough surface, its roughness parameters and its spectrum."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import xarray as xr

from asperity.fourier.grid import Fourier, Grid
from asperity.settings.map import MapOptions
from asperity.settings.sections import AS_SAMPLE
from asperity.surface.heights import johnson, with_heights, with_moments
from asperity.surface.reading.height_map import HeightMap, MapError
from asperity.surface.roughness import spectrum, surface_dataset
from asperity.surface.self_affine import self_affine, target_spectrum
from asperity.surface.treatment.treatment import cell_edge, make_periodic, treat_map, usable_map

_MAP_OPTIONS = MapOptions.model_fields.keys()


def make_surface(parameters: Mapping[str, Any], seed: int) -> xr.Dataset:
    """The random surface of one entry of the configuration and one seed.

    Parameters
    ----------
    parameters : mapping
        Entry of section ``surfaces`` of the configuration: hurst, wavelength_long, wavelength_short,
        rms_height, points, and optionally johnson, moments or heights. Lengths are in units of the cell
        edge.
    seed : int

    Returns
    -------
    dataset
        Heights, roughness parameters, spectrum, and the expected spectrum of the Gaussian surface. For a
        Gaussian surface also the standard errors of skewness and kurtosis, for a transformed one the spectrum
        before the transform, and for one with given heights the residuals of spectrum and heights.
    """
    grid = Grid((parameters["points"], parameters["points"]))
    band = {name: parameters[name] for name in ("hurst", "wavelength_long", "wavelength_short", "rms_height")}
    gaussian = height = self_affine(grid.shape, seed=seed, **band)
    if "johnson" in parameters:
        height = johnson(gaussian, **parameters["johnson"])
    elif "moments" in parameters:
        height = with_moments(gaussian, **parameters["moments"])
    elif "heights" in parameters:
        heights: dict[str, Any] = parameters["heights"]
        given: dict[str, Any] = {name: [*values.values()] for name, values in heights.items()}
        if "map" in heights:
            surface, options = _checked(AS_SAMPLE | heights["map"])
            given = {"sample": treat_map(surface, options).height[np.isfinite(surface.height)]}
        shaped = with_heights(gaussian, **given)
        height = shaped.height
    dataset = surface_dataset(height, grid)
    if "heights" in parameters:
        dataset["heights_residual"] = shaped.heights_residual
        dataset["spectrum_residual"] = shaped.spectrum_residual
    dataset["spectrum_target"] = ("wavenumber", target_spectrum(grid, **band)[1])
    if height is gaussian:
        dataset["skewness_error"], dataset["kurtosis_error"] = moment_errors(grid, **band)
    else:
        dataset["spectrum_before"] = ("wavenumber", spectrum(gaussian)[1])
    return dataset


def read_surface(parameters: Mapping[str, Any]) -> xr.Dataset:
    """The measured surface of one entry of the configuration, in units of the longer edge of its cell.

    Parameters
    ----------
    parameters : mapping
        Entry of section ``measured`` of the configuration: file, detrend, and optionally other fields of
        `asperity.surface.reading.height_map.MapOptions`, as `make_periodic` takes them.

    Returns
    -------
    dataset
        Heights, roughness parameters and spectrum. The attributes are the shortest wavelength kept and the
        `edge_step` of the period, and with the prefix ``map_`` the treatment of the map. If the unit of the
        map is known, ``map_cell_length`` is the longer edge of the cell in metres.

    Raises
    ------
    MapError
        If the map cannot be used; the message names everything that is wrong or missing.
    """
    surface, options = _checked(parameters)
    kept = make_periodic(surface, options)
    record: dict[str, Any] = {f"map_{name}": value for name, value in vars(kept.treatment).items()}
    if surface.unit is not None:
        record["map_cell_length"] = cell_edge(surface, options)
    return surface_dataset(kept.height, kept.grid).assign_attrs(
        wavelength_short=kept.wavelength_short,
        edge_step=kept.treatment.edge_step,
        map_treatment="\n".join(kept.done),
        **record,
    )


def map_problems(key: str, parameters: Mapping[str, Any]) -> tuple[str, ...]:
    """Everything for which `read_surface` would refuse the entry of this dotted key before it computes."""
    try:
        _checked(parameters)
    except MapError as error:
        return error.renamed(lambda field: f"{key}.{field}").lines
    return ()


def _checked(parameters: Mapping[str, Any]) -> tuple[HeightMap, MapOptions]:
    """The map of an entry of the configuration, and its options."""
    options = MapOptions(**{name: parameters[name] for name in _MAP_OPTIONS & parameters.keys()})
    needs_unit = isinstance(options.wavelength_short, str)
    return usable_map(parameters["file"], options, needs_unit), options


def moment_errors(
    grid: Grid, hurst: float, wavelength_long: float, wavelength_short: float, rms_height: float
) -> tuple[float, float]:
    """Standard errors of the skewness and the kurtosis of one sample of a Gaussian surface.

    They are √(6 ⟨ρ³⟩) and √(24 ⟨ρ⁴⟩), with the autocorrelation ρ of the surface averaged over the cell: the
    standard deviations of the means of the third and fourth Hermite polynomial of a Gaussian field, exact to
    first order. Parameters as for `asperity.surface.self_affine.target_spectrum`.
    """
    wavenumber, power = target_spectrum(grid, hurst, wavelength_long, wavelength_short, rms_height)
    width = wavenumber[0]
    ring = np.rint(grid.wavenumber() / width).astype(int)
    spread: np.ndarray = np.zeros(max(ring.max() + 1, power.size + 1))
    spread[np.rint(wavenumber / width).astype(int)] = power
    correlation = Fourier(grid).inverse(spread[ring].astype(complex), overwrite=True)
    correlation /= correlation[0, 0]
    power = correlation * correlation
    power *= correlation
    skewness = abs(power.mean())
    power *= correlation
    return float(np.sqrt(6 * skewness)), float(np.sqrt(24 * power.mean()))

"""Stage contact: the solid of the study pressed against a rough surface, and its load-area curve."""

from collections.abc import Mapping
from functools import partial
from typing import Any

import numpy as np
import xarray as xr

from asperity.contact import solve_load_path
from asperity.contact.half_grid import solve_on_half
from asperity.contact.solve import FULL_CONTACT, approach_of_full_contact
from asperity.core.types import Progress
from asperity.elasticity.solid import Solid, simplest_solid
from asperity.results.dataset import grid_of, height_of
from asperity.settings.sections import imposed_load
from asperity.stress.statistics.extrapolation import reason_against

SOLID_ATTRIBUTES = ("solid", "solid_reason", "solid_bound", "uniform_mode", "poisson_contact")
"""Global attributes of result files that describe the solid."""

SOLVER = {"method": "method", "rtol": "tolerance", "dtype": "precision", "hardness": "hardness"}
"""Argument of `solve_contact` → its setting in section ``contact``."""

CURVE = ("contact_area_fraction", "mean_pressure", "gradient_rms_contact")
"""Numbers of a contact that the load-area curve holds."""

_SMALLEST_WAVENUMBER = 2 * np.pi
"""Wavenumber of the longest wave on the unit cell, which reaches deepest."""


def solid(settings: Mapping[str, Any]) -> tuple[Solid, dict[str, Any]]:
    """The solid of a study and its description for the result files.

    Parameters
    ----------
    settings : mapping
        Section ``layer`` of the configuration: height, bottom, base, poisson, lateral, half_space_tolerance.
        Lengths are in units of the cell edge.

    Returns
    -------
    layer : Solid
        The layer of the settings, or the half-space if both differ by at most half_space_tolerance
        (`asperity.elasticity.solid.simplest_solid`). Young's modulus is 1 − ν², so that E* is one.
    record : dict
        The `SOLID_ATTRIBUTES`: the solid used, the reason and the difference, the condition of
        the mean (q = 0) mode, and Poisson's ratio.
    """
    poisson, base = settings["poisson"], settings.get("base")
    young = 1 - poisson**2
    own = {name: settings[name] for name in ("height", "bottom", "lateral")}
    below = None if base is None else Solid(young * base["modulus_ratio"], base["poisson"])
    layer = Solid(young, poisson, base=below, **own)
    chosen = simplest_solid(layer, _SMALLEST_WAVENUMBER, settings["half_space_tolerance"])
    record = {
        "solid": chosen.layer.description,
        "solid_reason": chosen.reason,
        "solid_bound": chosen.difference,
        "uniform_mode": f"laterally {settings['lateral']}",
        "poisson_contact": poisson,
    }
    return chosen.layer, record


def press_surface(
    surface: xr.Dataset,
    layer_settings: Mapping[str, Any],
    contact_settings: Mapping[str, Any],
    progress: Progress | None = None,
) -> xr.Dataset:
    """Contact at the load of the configuration, and at the area fractions of its load-area curve.

    Parameters
    ----------
    surface : dataset
        Result of stage surface.
    layer_settings, contact_settings : mapping
        Sections ``layer`` and ``contact`` of the configuration.
    progress : callable, optional
        Called as ``progress(done, total)``.

    Returns
    -------
    dataset
        Pressure, displacement and gap at the load of section ``contact``, and the load-area curve. The
        attributes hold the description of the solid (`SOLID_ATTRIBUTES`) and the
        certificate of the solution.

    Raises
    ------
    ConvergenceError
        If a contact does not converge.
    ValueError
        If the approach reaches full contact.
    """
    layer, record = solid(layer_settings)
    kind, value = imposed_load(contact_settings)
    height = surface["height"].values
    fractions = {*contact_settings.get("path_contact_area_fractions", ())}
    if kind == "contact_area_fraction":
        fractions.add(value)
    lowest = float(height.min())
    if kind == "normal_approach" and value >= (most := approach_of_full_contact(height, layer) - lowest):
        raise ValueError(
            f"contact.normal_approach = {value!r}: less than {most:.6g} is needed, {FULL_CONTACT}"
        )
    path = sorted(fractions)
    solver = {argument: contact_settings.get(name) for argument, name in SOLVER.items()}
    press = partial(solve_load_path, height, layer, grid_of(surface), progress=progress, **solver)
    curve = []
    for fraction, step in zip(path, press(contact_area_fractions=path), strict=True):
        curve.append([getattr(step, name) for name in CURVE])
        if kind == "contact_area_fraction" and fraction == value:
            contact = step
    if kind != "contact_area_fraction":
        own: Any = (
            {"mean_pressures": [value]} if kind == "mean_pressure" else {"approaches": [lowest + value]}
        )
        (contact,) = press(**own)
        curve = sorted([*curve, [getattr(contact, name) for name in CURVE]])
    solved, columns = contact.to_dataset(), zip(CURVE, np.array(curve).T, strict=True)
    dataset = solved.assign({f"path_{name}": ("load", values) for name, values in columns})
    certificate = {name: value for name, value in solved.attrs.items() if name.startswith("certificate_")}
    dataset.attrs = record | certificate
    return dataset.assign_coords(y=surface["y"], x=surface["x"])


def contact_on_half_the_nodes(contact: xr.Dataset, layer_settings: Mapping[str, Any]) -> xr.Dataset | None:
    """The same contact under the same load on half as many nodes, for estimates at zero grid spacing.

    Parameters
    ----------
    contact : dataset
        As of `press_surface`.
    layer_settings : mapping
        Section ``layer`` of the configuration.

    Returns
    -------
    dataset
        Pressure and numbers of the contact, with the attribute ``lost_gradient`` of
        `asperity.continuum_limit`; None where the contact allows no estimate.
    """
    height, grid = height_of(contact).values, grid_of(contact)
    plastic_area = float(contact.get("plastic_area", 0))
    if reason_against(contact["pressure"].values, height, plastic_area, bool(grid.mirrored)):
        return None
    layer, record = solid(layer_settings)
    half, lost = solve_on_half(height, layer, grid, mean_pressure=float(contact["mean_pressure"]))
    return half.to_dataset().assign_attrs(record, lost_gradient=lost)

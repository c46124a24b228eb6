"""Compilation at the first use of the library, with a line and a bar, before a command computes."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numba.core import event

from asperity.config.loads import without_load
from asperity.errors import ConvergenceError
from asperity.runtime.compiling import compiled_functions
from asperity.runtime.progress import ProgressBar
from asperity.surface.self_affine import self_affine

USED = {"run": 59, "contact": 33, "stress": 29, "planes": 23}
"""What a command computes → number of compiled functions that it calls, for the bar."""

NOTICE = "compiling, at the first use only"


def compile_visibly(what: str, small: Callable[[], object]) -> None:
    """Compile what a command needs, unless an earlier one has; says so on stderr.

    Parameters
    ----------
    what : str
        A key of `USED`.
    small : callable
        Does what the command does on a small surface, with the same types. What it refuses, the command
        itself refuses too.
    """
    with (
        event.install_listener("numba:compile", _Notice(USED[what])) as notice,
        contextlib.closing(notice),
        contextlib.suppress(ValueError, ConvergenceError),
    ):
        small()


class _Notice(event.Listener):
    """Says that functions are compiled when the first one is, and shows how many are done."""

    def __init__(self, used: int) -> None:
        self._used = used
        self._bar: ProgressBar | None = None

    def on_start(self, event: event.Event) -> None:
        if self._bar is None:
            if not sys.stderr.isatty():
                print(f"asperity: {NOTICE}, about 30 s", file=sys.stderr, flush=True)
            self._bar = ProgressBar(NOTICE).__enter__()

    def on_end(self, event: event.Event) -> None:
        done = sum(bool(function.signatures) for function in compiled_functions().values())
        if self._bar is not None:
            self._bar(min(done, self._used), self._used)

    def close(self) -> None:
        """Remove the bar."""
        if self._bar is not None:
            self._bar.__exit__(None)


def run_small(lower: Any, upper: Any, map_settings: Any, friction: float) -> None:
    """A run of ``asperity run`` on a small surface."""
    from asperity.engineering import Body, MapSettings, run
    from asperity.surface.height_map import HeightMap

    edge = lower.height or 1e-3
    height = np.random.default_rng(1).normal(size=(16, 16)) * 1e-3 * edge
    limited = Body(lower.young, lower.poisson, 1e-3 * lower.young, lower.height, lower.bottom)
    run(
        HeightMap(height, (edge, edge)),
        limited,
        upper,
        area_fraction=0.2,
        friction=friction,
        map_settings=MapSettings(boundary=map_settings.boundary),
    )


def solve_small(layer: Mapping[str, Any], contact: Mapping[str, Any]) -> None:
    """A contact of ``asperity solve`` on a small surface."""
    from asperity.pipeline.contact import solve_contact

    settings = without_load(contact) | {"tolerance": max(contact["tolerance"], 1e-4), "area_fraction": 0.1}
    settings["path_area_fractions"] = []
    solve_contact(_small_surface(), layer, settings)


def stress_small(layer: Mapping[str, Any], stress: Mapping[str, Any]) -> None:
    """An analysis of ``asperity stress`` under a small contact."""
    from asperity.pipeline.stress import compute_stress

    contact = _small_surface().rename(height="pressure")
    contact["pressure"] = np.maximum(-contact["pressure"], 0)
    from asperity.pipeline.solid import SOLID_ATTRIBUTES

    contact = contact.assign(gradient_rms_contact=1.0).assign_attrs(dict.fromkeys(SOLID_ATTRIBUTES, 0.0))
    compute_stress(contact, layer, stress)


def planes_small(solid: Any, fields: Sequence[str], poisson: float | None) -> None:
    """Planes of the stress, as views and exports compute them, under a small contact."""
    from asperity.spectral import Grid
    from asperity.stress.planes import stress_planes
    from asperity.stress.pressed import PressedSolid

    edge = max(solid.grid.length)
    pressure = np.maximum(-_small_surface()["height"].values, 0).astype(solid.pressure.dtype)
    small = PressedSolid(pressure, Grid(pressure.shape, (edge, edge)), solid.layer, solid.boundary)
    for tolerance in (0.0, 1e-4):
        for _ in stress_planes(small, [0.0, 0.01 * edge], poisson, fields, tolerance=tolerance):
            pass


def _small_surface() -> Any:
    import xarray as xr

    height = self_affine((32, 32), 0.8, 0.5, 0.125, 1e-3, seed=1)
    place = np.arange(32) / 32
    return xr.Dataset({"height": (("y", "x"), height)}, coords={"y": place, "x": place})

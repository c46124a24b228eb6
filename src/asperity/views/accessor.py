"""Methods of xarray datasets that hold a result of asperity, as ``dataset.asperity``.

Each method imports its modules when it is called, because this module is imported with the first name of
asperity.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import xarray as xr

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STAGES = {
    "plot": ("surface", "contact", "stress"),
    "section": ("contact",),
    "to_vtk": ("surface", "contact"),
    "select_peaks": ("stress",),
}
"""Method → stages whose results it takes."""


@xr.register_dataset_accessor("asperity")
class ResultAccessor:
    """Pictures, sections and peaks of a result, as ``dataset.asperity``.

    The dataset is one of `analyse_stress`, of `Contact.to_dataset`, or of a result file. Here, in
    `Contact` and in `asperity.views`, names that begin with ``plot`` return a figure, and all others data.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> stress = asp.analyse_stress(contact)
    >>> stress.asperity
    <result of stage stress: plot(), select_peaks()>
    >>> figure = stress.asperity.plot("von_mises")
    >>> int(stress.asperity.select_peaks("von_mises").sizes["peak"]) > 10
    True
    >>> contact.to_dataset().asperity.section(depths=[0.0, 0.02]).sizes["depth"]
    2
    """

    def __init__(self, dataset: xr.Dataset) -> None:
        self._dataset = dataset

    @property
    def stage(self) -> str | None:
        """The stage that made it, as of `asperity.results.dataset.stage_of`."""
        from asperity.results.dataset import stage_of

        return stage_of(self._dataset)

    def __repr__(self) -> str:
        methods = [name for name, stages in STAGES.items() if self.stage in stages]
        can = ", ".join(f"{name}()" for name in methods)
        return f"<result of stage {self.stage}: {can}>" if can else "<no result of asperity>"

    def plot(self, *arguments: Any, **settings: Any) -> Figure:
        """The picture of the stage: `plot_height`, `plot_pressure` or `plot_peaks`, with their arguments.

        Raises
        ------
        ValueError
            If the dataset is no result of these stages.
        """
        stage = self._needed("plot")
        from asperity.views import maps, peak_plot  # matplotlib is imported only to draw

        plots: dict[str, Callable[..., Figure]] = {
            "surface": maps.plot_height,
            "contact": maps.plot_pressure,
            "stress": peak_plot.plot_peaks,
        }
        return plots[stage](self._dataset, *arguments, **settings)

    def section(self, *arguments: Any, **settings: Any) -> xr.Dataset:
        """Stress in a vertical section below a contact: `stress_section`, with its arguments.

        Raises
        ------
        ValueError
            If the dataset is no contact that describes its solid.
        """
        self._needed("section")
        from asperity.elasticity.loaded_solid import LoadedSolid
        from asperity.stress.section import stress_section

        return stress_section(LoadedSolid.from_dataset(self._dataset), *arguments, **settings)

    def to_vtk(
        self,
        path: str | os.PathLike[str],
        fields: Sequence[str] = (),
        depth: tuple[float, float] | None = None,
        **settings: Any,
    ) -> None:
        """Write a surface or contact as VTK image data (``.vti``), for ParaView and pyvista.

        Parameters
        ----------
        path : path
        fields : names
            Fields of the stress below a contact; by default height, pressure, gap and displacement over the
            surface are written.
        depth : (first, last)
            Of the box in which the stress is written.
        **settings
            `y` and `x`, the part of the cell; for a stress also as in `asperity.views.export.box_below`.

        Raises
        ------
        ValueError
            If the dataset is no surface or contact, or an argument is out of range.
        """
        self._needed("to_vtk")
        from asperity.views import export
        from asperity.views.source import sources

        (source,) = sources(self._dataset)
        if not fields:
            export.write_surface_image(path, export.surface_fields(source, source.part(**settings)))
            return
        if depth is None:
            raise ValueError("depth = None: a pair (first, last) is needed for the fields of a stress")
        box = export.box_below(source, fields, depth, **settings)
        export.write_box(box, path, export.ExportUnits.of(source.system))

    def select_peaks(self, quantity: str, poisson: float | None = None, selection: str = "all") -> xr.Dataset:
        """Peaks of one quantity: `asperity.stress.select_peaks`, with its arguments.

        Raises
        ------
        ValueError
            If the dataset is no result of a stress analysis, or lacks the quantity.
        """
        self._needed("select_peaks")
        from asperity.stress.peaks.selection import select_peaks

        return select_peaks(self._dataset, quantity, poisson, selection)

    def _needed(self, method: str) -> str:
        """The stage, if it is one of those that a method takes."""
        if (stage := self.stage) not in (stages := STAGES[method]):
            needed = " or ".join(stages)
            raise ValueError(f"{method}: a result of stage {needed} is needed, not of {stage or 'none'}")
        return str(stage)

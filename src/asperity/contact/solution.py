"""The solved contact and its fields."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from asperity.contact.adhesion import Adhesion
from asperity.contact.certificate import Certificate
from asperity.contact.load import Tangent, load_interval, tangent
from asperity.contact.response import response_on
from asperity.core.arguments import magnitude
from asperity.core.errors import shown
from asperity.core.markup import picture, table
from asperity.core.types import Array, FilePath
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.elasticity.solid import Solid
from asperity.elasticity.two_bodies import Solids, TwoBodies
from asperity.fourier import current_engine
from asperity.fourier.grid import Grid, with_mirror_images

if TYPE_CHECKING:
    import xarray as xr
SHOWN_ERROR = 0.01
"""Relative error of an imposed area above which the summary of a contact states it."""


@dataclass(frozen=True, eq=False, repr=False)
class Contact:
    """A solved contact; stresses are in the unit of Young's modulus, lengths in the unit of the heights.

    Attributes
    ----------
    height, pressure, displacement, gap : (ny, nx) arrays
        Lower face of the indenter, contact pressure, downward displacement of the solid's surface, and gap.
        For two bodies, the displacements of both surfaces are added.
    grid : Grid
        Of the map; fields are given on the map alone, also if its mirror images continue it.
    solid : Solid or TwoBodies
    boundary : "periodic" | "free" | "free along y" | "free along x"
        Condition at the edges of the map; "periodic" of a mirrored one.
    contact_area_fraction : float
        Number of nodes that touch over the number of all nodes of the map.
    mean_pressure : float
        Load over the area of the map.
    approach : float
        Position δ of the indenter: depth of its plane of height 0 below the undeformed surface. It first
        touches at ``height.min()``. See `asperity.contact.solve`.
    certificate : Certificate
        Violations of the conditions of contact, evaluated anew from the pressure, and the work spent.
    control_error : float
        Relative difference between the imposed and the reached area or load. Only an area can be missed: if
        several nodes touch at the same load, as the lowest ones of a flat or stepped surface, or if one node
        is more than the area asked for. Then the area is the nearest that the surface allows.
    method : str
    rtol : float
    hardness : float
        Maximum pressure, infinite in an elastic contact.
    plastic_depth : (ny, nx) array or None
        Depth by which the surface is flattened where the pressure is the hardness: the overlap of the bodies,
        zero elsewhere. The gap is measured from the flattened surface. None without a hardness.
    adhesion : Adhesion or None
        The pressure is then down to ``-adhesion.strength``.
    attraction : (ny, nx) array or None
        Traction with which the faces attract each other; pressure and attraction together are the reaction of
        the faces where they touch. None without adhesion.
    fft_engine : str
        Library of the Fourier transforms, its version and plans.

    Examples
    --------
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> contact = asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), contact_area_fraction=0.1)
    >>> round(contact.contact_area_fraction, 3), contact.pressure.shape
    (0.1, (64, 64))
    >>> bool(contact.gap[contact.pressure > 0].max() < 1e-8)  # closed where there is pressure
    True
    >>> contact.certificate.worst < 1e-5
    True
    >>> figure = asp.views.plot_pressure(contact)
    >>> asp.stress_section(contact, "x", depths=[0.0, 0.02])["von_mises"].dims
    ('poisson', 'depth', 'x')
    >>> float(contact.to_dataset()["contact_area_fraction"]) == contact.contact_area_fraction
    True
    """

    height: Array
    pressure: Array
    displacement: Array
    gap: Array
    grid: Grid
    solid: Solids
    boundary: str
    contact_area_fraction: float
    mean_pressure: float
    approach: float
    certificate: Certificate
    control_error: float
    method: str
    rtol: float
    hardness: float = np.inf
    plastic_depth: Array | None = None
    adhesion: Adhesion | None = None
    attraction: Array | None = None
    fft_engine: str = field(default_factory=lambda: current_engine().description)

    def __repr__(self) -> str:
        ny, nx = self.grid.shape
        missed = f" (imposed area missed by {100 * self.control_error:.2g} %)"
        return (
            f"<Contact of {ny} × {nx} nodes: contact area fraction {self.contact_area_fraction:.4g}"
            f"{missed if self.control_error > SHOWN_ERROR else ''}, "
            f"mean pressure {self.mean_pressure:.4g}, maximum pressure {self.maximum_pressure:.4g}, "
            f"approach {self.approach:.4g}>"
        )

    def _repr_html_(self) -> str:
        ny, nx = self.grid.shape
        height, width = self.grid.length
        rows = [
            ("nodes", f"{ny} × {nx}, {self.boundary}"),
            ("cell", f"{height:.4g} × {width:.4g}"),
            ("solid", repr(self.solid)),
            ("real contact", f"{100 * self.contact_area_fraction:.4g} %"),
            (
                "pressure: mean, in contact, maximum",
                f"{self.mean_pressure:.4g}, {self.mean_contact_pressure:.4g}, {self.maximum_pressure:.4g}",
            ),
            ("approach", f"{self.approach:.4g}"),
            *([("plastic", f"{100 * self.plastic_area:.4g} %")] if np.isfinite(self.hardness) else []),
            ("maximum violation", f"{self.certificate.worst:.2g}"),
        ]
        return table("Contact", rows, picture(self.pressure, "contact pressure"))

    def to_dataset(self, unit_system: str = "SI") -> xr.Dataset:
        """Fields over y and x and numbers of the contact; the solid as attributes.

        Of two bodies, the attributes describe the lower one.

        Parameters
        ----------
        unit_system : str
            Units of the values: "SI", so that lengths are in m and stresses in Pa, or "cell length and
            effective modulus", the units of the study. The values stay as they are.
        """
        import xarray as xr

        lower = self._bodies["lower"]
        names = {"lower": "layer", "upper": "upper"}
        settings = {names[body]: _settings(layer) for body, layer in self._bodies.items()}
        certificate = {f"certificate_{name}": value for name, value in asdict(self.certificate).items()}
        del certificate["certificate_seconds"]
        fields = ["pressure", "displacement", "gap"]
        fields += ["contact_area_fraction", "mean_pressure", "approach", "gradient_rms_contact"]
        if self.plastic_depth is not None:
            fields += ["plastic_depth", "plastic_area", "plastic_load", "hardness"]
        attracted = {}
        if self.attraction is None:
            del certificate["certificate_attraction"], certificate["certificate_stability"]
        else:
            fields.append("attraction")
            attracted = {"adhesion": json.dumps(asdict(self.adhesion))}  # type: ignore[arg-type]
        values = {name: getattr(self, name) for name in fields}
        return xr.Dataset(
            {name: (("y", "x"), value) if np.ndim(value) else value for name, value in values.items()},
            coords=self.grid.dataset_coordinates(),
            attrs={
                "unit_system": unit_system,
                "settings": json.dumps(settings, sort_keys=True),
                "boundary": self.boundary,
                "effective_modulus": self.solid.effective_modulus,
                "solid": lower.description,
                "solid_reason": "asked for",
                "solid_bound": 0.0,
                "uniform_mode": f"laterally {lower.lateral}",
                "poisson_contact": lower.poisson,
                "young": lower.young,
                "method": self.method,
                "fft_engine": self.fft_engine,
                **certificate,
                **attracted,
            },
        )

    def to_netcdf(self, path: FilePath, unit_system: str = "SI") -> None:
        """Write `to_dataset` as a result file, which `asperity.read_result` and the command line read.

        Raises
        ------
        DatasetError
            If the file cannot be written.
        """
        from asperity.results.dataset import write_result

        write_result(self.to_dataset(unit_system), path, "Contact with a rough surface")

    @property
    def _bodies(self) -> dict[str, Solid]:
        """Name → body, one under a rigid indenter."""
        if isinstance(self.solid, TwoBodies):
            return {"lower": self.solid.lower, "upper": self.solid.upper}
        return {"lower": self.solid}

    @property
    def layer(self) -> Solid:
        """The solid that was pressed, if it is one; an `AttributeError` if there are two bodies."""
        if isinstance(self.solid, TwoBodies):
            raise AttributeError(
                "layer: this contact has two bodies; in_body('lower') or in_body('upper') is needed"
            )
        return self.solid

    @property
    def edges_meet(self) -> bool:
        """True if opposite edges of the map are neighbours: it repeats, and not by its mirror images."""
        return self.boundary == "periodic" and not self.grid.mirrored

    @property
    def touching(self) -> Array:
        """Nodes [y, x] that touch: under pressure, with adhesion also in tension where the gap is closed."""
        return self.pressure > 0 if self.attraction is None else self.pressure + self.attraction > 0

    @property
    def force(self) -> float:
        """Load: mean pressure times the area of the map."""
        return self.mean_pressure * self.grid.area

    @property
    def maximum_pressure(self) -> float:
        """Maximum contact pressure."""
        return float(self.pressure.max())

    @property
    def mean_contact_pressure(self) -> float:
        """Mean pressure of the nodes that touch, without adhesion load over contact area; NaN without any."""
        if self.adhesion is not None and self.contact_area_fraction:
            return float(self.pressure.mean(where=self.touching))
        return self.mean_pressure / self.contact_area_fraction if self.contact_area_fraction else float("nan")

    @property
    def plastic_area(self) -> float:
        """Number of nodes at the hardness over the number of all nodes of the map."""
        return float(np.mean(self.pressure >= self.hardness))

    @property
    def plastic_load(self) -> float:
        """Fraction of the load on nodes at the hardness; with adhesion of the pressures without tension."""
        if not self.plastic_area:
            return 0.0
        borne = self.mean_pressure if self.adhesion is None else float(np.maximum(self.pressure, 0).mean())
        return self.plastic_area * self.hardness / borne

    def flattened_height(self) -> Array:
        """Height of the indenter [y, x] after this load: its plastic nodes are raised by the plastic depth.

        Pressed elastically under the same load, it has the same pressure.
        """
        return self.height if self.plastic_depth is None else self.height + self.plastic_depth

    @cached_property
    def load_interval(self) -> tuple[float, float]:
        """Least and largest mean pressure under which the same nodes touch.

        An imposed area fixes the load no closer than this. The largest one is infinite in full contact. With
        a hardness the same nodes are plastic, too. Not known with adhesion.
        """
        self._require_repulsive("load_interval")
        gap = self.gap if self.plastic_depth is None else self.gap - self.plastic_depth
        return load_interval(self.pressure, gap, self.hardness, self._tangent)

    @cached_property
    def _tangent(self) -> Tangent | None:
        """Change under further loading, at the same attraction; None if no node moves."""
        moving = self.touching & (self.pressure < self.hardness)
        return tangent(moving, self.grid, self.solid, self.boundary)

    @property
    def stiffness(self) -> float:
        """Change dp̄/dδ of the mean pressure per approach under further loading, in stress per length.

        Nodes at the hardness keep their pressure. Zero without contact, and infinite in full contact of a
        periodic solid without uniform displacement. Not known with adhesion, whose force may fall.
        """
        self._require_repulsive("stiffness")
        return _inverse(self._tangent)

    def _require_repulsive(self, what: str) -> None:
        if self.adhesion is not None:
            raise ValueError(f"{what}: a contact without adhesion is needed")

    def conductance(self, resistivity: float) -> float:
        """Conductance of the real contact per nominal area, electrical or thermal, between two half-spaces.

        It follows from the stiffness K of all nodes in contact as 2 K / (E* ρ) (J. R. Barber, Proc. R. Soc. A
        459 (2003) 53, DOI 10.1098/rspa.2002.1038). Films and conduction through the gap are left out.

        Parameters
        ----------
        resistivity : float
            Sum ρ of the resistivities of both bodies; for heat, of one over the conductivity.

        Raises
        ------
        ValueError
            If it is not above 0, or the solid is a layer, whose own compression is a part of the stiffness.

        Examples
        --------
        A circle of radius a between two half-spaces conducts 4 a / ρ:

        >>> ball = asp.surface.add_sphere(np.zeros((64, 64)), 1.0, radius=10.0)
        >>> contact = asp.solve_contact(ball, asp.Solid(1.0, 0.3), force=2e-3, boundary="free")
        >>> radius = np.sqrt(contact.contact_area_fraction / np.pi)
        >>> bool(abs(contact.conductance(2.0) / (4 * radius / 2.0) - 1) < 0.03)
        True
        """
        resistivity = magnitude("resistivity", resistivity)
        if self.solid.height is not None:
            raise ValueError(f"solid = {self.solid!r}: half-spaces are needed for a conductance")
        moves = self._tangent
        if self.plastic_area:
            moves = tangent(self.touching, self.grid, self.solid, self.boundary)
        return 2 * _inverse(moves) / (self.solid.effective_modulus * resistivity)

    def in_body(self, body: str) -> LoadedSolid:
        """One body under the contact pressure, for the stress inside it.

        Depth is measured from the surface into the body, also in the upper one, and z points out of the body.
        The shear stresses yz and xz in the upper body therefore have the opposite sign in the coordinates of
        the lower one; all other components are the same.

        Parameters
        ----------
        body : "lower" | "upper"
            "lower" is the solid under a rigid indenter.

        Raises
        ------
        ValueError
            If there is no such body.
        """
        layers = self._bodies
        if not isinstance(body, str) or body not in layers:
            accepted = "'lower' or 'upper'" if len(layers) > 1 else "'lower', because the indenter is rigid,"
            raise ValueError(f"body = {shown(body)}: {accepted} is needed")
        return LoadedSolid(self.pressure, self.grid, layers[body], self.boundary, self.hardness)

    @cached_property
    def gradient_rms_contact(self) -> float:
        """Root-mean-square gradient of the deformed surface over the nodes that touch (the paper's ḡ_r).

        By spectral differentiation, with a free boundary from the closed form for the slope beside a loaded
        rectangle; NaN without contact.
        """
        touching = self.touching
        if not touching.any():
            return float("nan")
        grid, pressure, displacement = self.grid, self.pressure, self.displacement
        if isinstance(grid.mirrored, tuple):
            pressure, displacement = (with_mirror_images(each, grid) for each in (pressure, displacement))
            grid = grid.whole_cell
        response = response_on(self.boundary, self.solid, grid, displacement.dtype)
        slope_y, slope_x = (slope[self.grid.map] for slope in response.gradient(pressure, displacement))
        return float(np.sqrt((slope_y[touching] ** 2 + slope_x[touching] ** 2).mean(dtype=float)))


def adhesion_of(stored: xr.Dataset) -> Adhesion | None:
    """Adhesion of a stored contact."""
    return Adhesion(**json.loads(stored.attrs["adhesion"])) if "adhesion" in stored.attrs else None


def _inverse(found: Tangent | None) -> float:
    """Stiffness of a tangent."""
    if found is None:
        return 0.0
    return 1 / found.approach if found.approach > 0 else np.inf


def _settings(layer: Solid) -> dict[str, Any]:
    """Parameters of a layer; only its height may be None, for a half-space."""
    return {name: value for name, value in asdict(layer).items() if value is not None or name == "height"}

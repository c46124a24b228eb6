"""The solved contact and its fields."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from asperity.contact.certificate import Certificate
from asperity.elasticity.layer import Layer
from asperity.spectral import Fourier, Grid, gradient
from asperity.types import Array


@dataclass(frozen=True, eq=False)
class Contact:
    """A solved contact.

    Attributes
    ----------
    height, pressure, displacement, gap : (ny, nx) arrays
        Lower face of the indenter, contact pressure, downward displacement of the solid's surface, and gap.
    grid : Grid
    layer : Layer
    area_fraction : float
        Number of nodes under pressure over the number of all nodes.
    mean_pressure : float
        Load over the area of the cell.
    approach : float
        Position of the indenter.
    certificate : Certificate
        Violations of the conditions of contact, evaluated anew from the pressure, and the work spent.
    method : str
    rtol : float
    """

    height: Array
    pressure: Array
    displacement: Array
    gap: Array
    grid: Grid
    layer: Layer
    area_fraction: float
    mean_pressure: float
    approach: float
    certificate: Certificate
    method: str
    rtol: float

    @cached_property
    def gradient_rms_contact(self) -> float:
        """Root-mean-square gradient of the deformed surface over the nodes under pressure (the paper's ḡ_r).

        By spectral differentiation; NaN without contact.
        """
        touching = self.pressure > 0
        if not touching.any():
            return float("nan")
        fourier = Fourier(self.grid, self.displacement.dtype)
        slope_y, slope_x = gradient(fourier.forward(self.displacement), fourier)
        return float(np.sqrt((slope_y[touching] ** 2 + slope_x[touching] ** 2).mean(dtype=float)))

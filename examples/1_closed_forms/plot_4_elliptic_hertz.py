r"""
Crossed cylinders: an ellipse of contact
========================================

Two crossed rollers of different radii touch in an ellipse. The form of each is a parabola, and
``add_cylinder`` adds one after the other. Semi-axes and pressure follow from elliptic integrals (Hertz
1882).
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.patches import Ellipse

import asperity as asp
from asperity.reference.elliptic_hertz import EllipticHertz

steel = asp.Solid(young=210e9, poisson=0.3)
force, radius_x, radius_y = 20.0, 20e-3, 5e-3  # curvature along x and along y
grid = asp.Grid((96, 128), (0.24e-3, 0.4e-3))

# %%
# A cylinder with its axis along y curves along x.
height = asp.surface.add_cylinder(np.zeros(grid.shape), grid, radius_x, axis="y")
height = asp.surface.add_cylinder(height, grid, radius_y, axis="x")
contact = asp.solve_contact(height, steel, grid.length, force=force, boundary="free")
hertz = EllipticHertz.from_load(force, radius_x, radius_y, steel.effective_modulus)

figure, axes = plt.subplots(figsize=(6, 3.4), layout="compressed")
asp.views.plot_pressure(contact, axes=axes, unit_system="SI")
middle = [(axis[0] + axis[-1]) / 2 * 1e6 for axis in grid.coordinates()]
size = 2e6 * hertz.semi_major, 2e6 * hertz.semi_minor
axes.add_patch(Ellipse((middle[1], middle[0]), *size, fill=False, linestyle="--"))
plt.show()

# %%
# **Check**: maximum pressure, semi-axes, and the maximum von Mises stress below the middle.
print(f"p₀ {contact.maximum_pressure / 1e6:.0f} MPa, closed form {hertz.maximum_pressure / 1e6:.0f} MPa")
assert abs(contact.maximum_pressure / hertz.maximum_pressure - 1) < 0.005
touching = contact.pressure > 0
widths = [
    np.ptp(np.nonzero(touching.any(axis=other))[0]) * step
    for other, step in ((1, grid.spacing[0]), (0, grid.spacing[1]))
]
assert abs(widths[0] - 2 * hertz.semi_minor) < 2 * grid.spacing[0]
assert abs(widths[1] - 2 * hertz.semi_major) < 2 * grid.spacing[1]
peak = hertz.maximum_von_mises_on_axis(steel.poisson)
depths = np.linspace(0.8, 1.2, 9) * peak.depth
largest = max(plane.fields["von_mises"].max() for plane in asp.stress_planes(contact, depths))
assert abs(largest / peak.value - 1) < 0.01

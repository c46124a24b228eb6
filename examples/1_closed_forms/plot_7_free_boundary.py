r"""
A free boundary against a periodic one
======================================

A measured map and a ball on a flat do not repeat. A periodic cell presses an array of balls instead, whose
neighbours deform the solid too. The free boundary has no neighbours; it differs where the contact is as
wide as the cell.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.reference.hertz import Hertz

solid = asp.Solid(young=1.0, poisson=0.3)
grid = asp.Grid((96, 96), 1.0)
ball = asp.surface.add_sphere(np.zeros(grid.shape), grid, radius=20.0)
contact_radius = np.array([0.15, 0.25, 0.35, 0.45])
forces = [Hertz(a, 20.0, solid.effective_modulus).load for a in contact_radius]

# %%
# The same loads with both boundaries. The maximum pressure is compared with Hertz.
errors = {}
for boundary in ("free", "periodic"):
    path = asp.solve_load_path(ball, solid, grid.length, forces=forces, boundary=boundary)
    hertz = [Hertz(a, 20.0, solid.effective_modulus).maximum_pressure for a in contact_radius]
    errors[boundary] = np.array([contact.maximum_pressure for contact in path]) / hertz - 1

figure, axes = plt.subplots(figsize=(6, 3.6), layout="compressed")
for boundary, error in errors.items():
    axes.plot(contact_radius, 100 * error, "o-", label=boundary)
axes.set(xlabel="contact radius/edge of the map", ylabel="maximum pressure, % above Hertz")
axes.legend()
plt.show()

# %%
# A rough ball under the free boundary: the approach is absolute, so that it can be compared with a test rig.
roughness = asp.self_affine(grid.shape, 0.8, 0.25, 0.06, 4e-5, seed=1)
rough = asp.solve_contact(ball + roughness, solid, grid.length, force=forces[1], boundary="free")
print(f"displacement of the ball {rough.approach - (ball + roughness).min():.2e} edges of the map")
figure, axes = plt.subplots(figsize=(4.6, 3.8), layout="compressed")
asp.views.plot_pressure(rough, axes=axes)
plt.show()

# %%
# **Check**: the free contact agrees with Hertz for every radius; the periodic one departs from it as the
# neighbours come near.
assert np.abs(errors["free"]).max() < 0.004
assert np.all(np.diff(np.abs(errors["periodic"])) > 0)
assert abs(errors["periodic"][-1]) > 10 * abs(errors["free"][-1])
assert abs(rough.force / forces[1] - 1) < 1e-9

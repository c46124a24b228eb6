r"""
A layer between two rough faces
===============================

A thin sheet pressed between two rough surfaces, such as a gasket or a separator, bears the stress of both.
Each face is known by its tractions, here the pressures of two contacts; `asperity.elasticity.layer_fields`
solves for
stress and displacement in the whole layer. The same call takes displacements in place of tractions, for
instance those that an image correlation has measured on a face.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

grid = asp.Grid((99, 99), 1.0)  # odd: a grid holds no sine at its Nyquist wavenumber
sheet = asp.Solid(young=1.0, poisson=0.4, height=0.12)
# Each contact is solved with half of the sheet, because the middle plane hardly moves.
half = asp.Solid(young=1.0, poisson=0.4, height=0.06, bottom="frictionless")
pressures = {}
for face, seed, shortest in (("top", 1, 1 / 24), ("bottom", 2, 1 / 12)):
    height = asp.self_affine(grid.shape, 0.8, 1 / 3, shortest, rms_height=1e-3, seed=seed)
    pressures[face] = asp.solve_contact(height, half, grid, mean_pressure=0.01).pressure
top, bottom = ({"pressure": pressure} for pressure in pressures.values())

# %%
# The planes are streamed; the figure keeps one row of nodes of each. Peaks of the stress lie below the
# contacts of either face, and meet in the middle where contacts face each other.
solved = asp.elasticity.layer_fields(sheet, grid, top, bottom)
depths = np.linspace(0, sheet.height, 41)
row = int(np.argmax(np.minimum(pressures["top"], pressures["bottom"])) // grid.shape[1])
section = np.array([plane.fields["von_mises"][row] for plane in solved.planes(depths)])

figure, (above, middle, below) = plt.subplots(
    3, 1, figsize=(7, 5), sharex=True, layout="compressed", height_ratios=(1, 2, 1)
)
x = grid.coordinates()[1]
above.fill_between(x, pressures["top"][row])
below.fill_between(x, pressures["bottom"][row])
below.invert_yaxis()
image = middle.pcolormesh(x, -depths, section, vmax=np.percentile(section, 99.5), shading="nearest")
figure.colorbar(image, ax=middle, label="von Mises stress/E")
middle.set_ylabel("−depth/L")
above.set_ylabel("pressure/E")
below.set(xlabel="x/L", ylabel="pressure/E")
plt.show()

# %%
# **Check**: every plane carries the load, and the faces bear their pressures. Between two equal faces the
# middle plane does not move: the sheet is a layer of half its height on a frictionless support.
for plane in solved.planes([0.0, 0.05, sheet.height]):
    np.testing.assert_allclose(plane.fields["zz"].mean(), -0.01, rtol=1e-12)
for pressure, plane in zip(pressures.values(), solved.planes([0.0, sheet.height]), strict=True):
    np.testing.assert_allclose(plane.fields["zz"], -pressure, atol=1e-12)
(equal,) = asp.elasticity.layer_fields(sheet, grid, top, top).planes(0.02)
pressed = asp.LoadedSolid(pressures["top"], grid, half)
(expected,) = asp.stress_planes(pressed, [0.02], tolerance=0)
np.testing.assert_allclose(equal.fields["von_mises"], expected.fields["von_mises"][0], rtol=1e-11)

# %%
# **Check**: the displacement of the top face, as if it had been measured, in place of its pressure gives the
# same stress inside. The tractions of the top follow from it.
surface = next(solved.planes(0.0)).fields
measured = {name: surface[name] for name in ("displacement_x", "displacement_y", "displacement_z")}
again = asp.elasticity.layer_fields(sheet, grid, measured, bottom)
for found, plane in zip(again.planes([0.0, 0.05]), solved.planes([0.0, 0.05]), strict=True):
    np.testing.assert_allclose(found.fields["zz"], plane.fields["zz"], atol=1e-11)

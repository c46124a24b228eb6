r"""
A cell of a Hertz contact
=========================

A map of a rough ball is small compared with the contact of the ball. ``HertzContact.background`` adds the
stress of the smooth contact to that of the map as a periodic cell. Here a wavy ball is small enough to be
resolved as a whole, so that the stress of the cell can be tested.
"""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

solid, radius, half = asp.Solid(young=1.0, poisson=0.3), 1.0, 0.1
ball = asp.stress.HertzContact.from_radii(
    radius, radius, solid.effective_modulus, force=4 / 3 * half**3 / 0.91
)
largest, wave = ball.maximum_pressure, half / 6

# %%
# The whole ball with a wave along x in complete contact, whose pressure has half of p₀ as amplitude.
edge, nodes = 2.4 * half, 256
x = (np.arange(nodes) - nodes // 2) * edge / nodes
amplitude = largest * wave / (2 * np.pi * solid.effective_modulus)
height = (x**2 + x[:, None] ** 2) / (2 * radius) + amplitude * (1 - np.cos(2 * np.pi * x / wave))
whole = asp.solve_contact(height, solid, edge, boundary="free", force=4 / 3 * half**3 / 0.91)

# %%
# One wave as a periodic cell in the middle of the contact.
pressure = largest * (1 + 0.5 * np.cos(2 * np.pi * np.arange(32) / 32)) * np.ones((8, 1))
alone = asp.LoadedSolid(pressure, asp.Grid((8, 32), (wave / 4, wave)), solid)
cell = replace(alone, background=ball.background(0.0, 0.0, solid))

depths = wave * np.linspace(0, 4, 33)
stress = {}
for name, loaded, node in (
    ("whole ball", whole, nodes // 2),
    ("cell in the contact", cell, 0),
    ("cell alone", alone, 0),
):
    planes = asp.stress_planes(loaded, depths, tolerance=0)
    stress[name] = np.array([plane.fields["von_mises"][0, node, node] for plane in planes]) / largest

figure, axes = plt.subplots(figsize=(6, 4), layout="compressed")
for (name, values), style in zip(stress.items(), ("-", "o", ":"), strict=True):
    axes.plot(values, depths / wave, style, label=name, mfc="none")
axes.set(xlabel="von Mises stress/p₀ below a crest", ylabel="depth/wavelength", ylim=(4, 0))
axes.legend()
plt.show()

# %%
# **Check**: with the added stress the cell has the stress of the whole ball at all depths; without it the
# error is a half.
error = {name: np.abs(values / stress["whole ball"] - 1).max() for name, values in stress.items()}
print(
    f"error of the cell {100 * error['cell in the contact']:.2f} %, alone {100 * error['cell alone']:.0f} %"
)
assert error["cell in the contact"] < 5e-3
assert error["cell alone"] > 0.5

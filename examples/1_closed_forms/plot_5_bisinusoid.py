r"""
Wavy surface: from the first touch to complete contact
======================================================

A surface :math:`A[\sin^2(\pi x/\lambda) + \sin^2(\pi y/\lambda)]` touches completely at the mean pressure
:math:`p^* = \pi E^* A/\lambda`. Johnson, Greenwood and Higginson (1985) gave the contact area at both ends:
at small loads each crest is a Hertz contact, and close to complete contact the gap is a circle.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.reference.bisinusoid import Bisinusoid

solid = asp.Solid(young=1.0, poisson=0.0)  # E* = 1
wave = Bisinusoid(amplitude=1e-3, wavelength=1.0, effective_modulus=solid.effective_modulus)
grid = asp.Grid((96, 96), 1.0)
y, x = grid.coordinates()
height = wave.height(y[:, None], x)

# %%
# One load after the other, each solved from the solution before.
shares = np.array([0.003, 0.01, 0.03, 0.1, 0.2, 0.4, 0.6, 0.8, 0.9, 0.95, 0.99])
loads = shares * wave.complete_pressure
areas = np.array(
    [contact.contact_area_fraction for contact in asp.solve_load_path(height, solid, mean_pressures=loads)]
)

figure, axes = plt.subplots(figsize=(6, 3.8), layout="compressed")
axes.plot(shares, areas, "o", label="computed")
fine = np.linspace(0.001, 1, 300)
small = [wave.small_contact_area_fraction(share * wave.complete_pressure) for share in fine]
large = [wave.nearly_complete_contact_area_fraction(share * wave.complete_pressure) for share in fine]
axes.plot(fine[fine < 0.3], np.array(small)[fine < 0.3], label="small loads: Hertz")
axes.plot(fine[fine > 0.6], np.array(large)[fine > 0.6], label="nearly complete contact")
axes.set(xlabel="mean pressure/p*", ylabel="contact area/nominal area")
axes.legend()
plt.show()

# %%
# **Check**: both asymptotes, areas that rise, and complete contact at 1.01 p* with the pressure of a wave.
assert np.all(np.diff(areas) > 0)
assert abs(areas[0] / wave.small_contact_area_fraction(loads[0]) - 1) < 0.03
assert abs((1 - areas[-1]) / (1 - wave.nearly_complete_contact_area_fraction(loads[-1])) - 1) < 0.05
full = asp.solve_contact(height, solid, mean_pressure=1.01 * wave.complete_pressure)
exact = wave.complete_contact_pressure(y[:, None], x, full.mean_pressure)
assert full.contact_area_fraction == 1
assert np.abs(full.pressure - exact).max() < 1e-5 * exact.max()

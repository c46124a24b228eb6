r"""
Self-affine surfaces: the Hurst exponent
========================================

The power spectral density of a self-affine surface falls as :math:`q^{-2(1 + H)}`. A smaller Hurst exponent
means more short waves, hence finer contacts, and stress peaks that lie nearer to the surface. One seed
gives the surfaces of all exponents the same phases, so that they are compared wave by wave.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

solid = asp.Solid(young=1.0, poisson=0.33)
wavelengths = {"wavelength_long": 1 / 4, "wavelength_short": 1 / 32}
exponents = (0.2, 0.5, 0.8)

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="compressed")
slopes, contacts, depths, numbers = [], {}, [], []
for hurst in exponents:
    height = asp.self_affine((256, 256), hurst, rms_height=1e-3, seed=1, **wavelengths)
    wavenumber, power = asp.surface.spectrum(height)
    inside = (wavenumber > 2 * np.pi * 4.5) & (wavenumber < 2 * np.pi * 31)
    slopes.append(np.polyfit(np.log(wavenumber[inside]), np.log(power[inside]), 1)[0])
    left.loglog(wavenumber[inside], power[inside], label=f"H = {hurst}")
    contact = asp.solve_contact(height, solid, contact_area_fraction=0.1)
    stress = asp.analyse_stress(contact, quantities=("von_mises",), tolerance=1e-4)
    found = asp.stress.select_peaks(stress, "von_mises", selection="under_contact")
    value = found["peak_value"] / (contact.solid.effective_modulus * contact.gradient_rms_contact)
    right.scatter(value, found["peak_depth"] / wavelengths["wavelength_short"], s=3, label=f"H = {hurst}")
    contacts[f"H = {hurst}"] = contact
    depths.append(float(found["peak_depth"].median()))
    numbers.append(found.sizes["peak"])
left.set(xlabel="wavenumber q", ylabel="power spectral density")
left.xaxis.set_minor_formatter("")
left.legend()
right.set(xlabel=r"von Mises peak/(E* $\bar g_r$)", ylabel="depth/λ_s", ylim=(0.5, 0))
right.legend()
plt.show()

# %%
# The contacts of 10 % of the area.
figure, axes = plt.subplots(1, 3, figsize=(10, 3.4), layout="compressed")
asp.views.plot_pressure(contacts, axes=axes)
plt.show()

# %%
# **Check**: the slope of the spectrum, and more peaks nearer to the surface for a smaller exponent.
print("slopes", np.round(slopes, 2), "median depths", np.round(depths, 4), "peaks", numbers)
for hurst, slope in zip(exponents, slopes, strict=True):
    assert abs(slope + 2 * (1 + hurst)) < 0.15
assert depths[0] < depths[1] < depths[2]
assert numbers[0] > numbers[1] > numbers[2]

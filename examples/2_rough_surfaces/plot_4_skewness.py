r"""
Blunt and sharp surfaces: skewness
==================================

Grinding leaves sharp peaks, running-in and lapping leave plateaus with deep grooves. Johnson's transform
gives the heights of a Gaussian surface a chosen skewness and kurtosis and keeps the rms height. The
height of the indenter is its lower face, measured upward: a *positive* skewness is a long tail upward, away
from the solid, so the contacts are blunt.
"""

import matplotlib.pyplot as plt

import asperity as asp

solid = asp.Solid(young=1.0, poisson=0.33)
gaussian = asp.self_affine((192, 192), 0.8, 1 / 4, 1 / 24, rms_height=1e-3, seed=1)
surfaces = {
    "sharp": asp.surface.with_moments(gaussian, skewness=-0.9, kurtosis=4.0),
    "Gaussian": gaussian,
    "blunt": asp.surface.with_moments(gaussian, skewness=0.9, kurtosis=4.0),
}

# %%
figure, axes = plt.subplots(figsize=(6, 3.6), layout="compressed")
contacts, moments = {}, {}
for name, height in surfaces.items():
    moments[name] = asp.roughness_parameters(height)
    density = asp.stress.probability_density(height / moments[name].rms_height, bins=50, limits=(-5, 5))
    axes.stairs(density.density, density.edges, label=f"{name}: skewness {moments[name].skewness:+.2f}")
    contacts[name] = asp.solve_contact(height, solid, mean_pressure=0.002 * solid.effective_modulus)
axes.set(xlabel="height/rms height", ylabel="probability density", ylim=(0, 0.7))
axes.legend()
plt.show()

# %%
# At one load the sharp surface has the smaller area and the higher pressure.
for name, contact in contacts.items():
    print(
        f"{name:9s} area {contact.contact_area_fraction:.3f}  "
        f"maximum pressure {contact.maximum_pressure:.4f} E*"
    )

# %%
# **Check**: the moments to the scatter of one sample, the same rms height, and the order of areas and
# pressures.
assert abs(moments["blunt"].skewness - 0.9) < 0.25
assert abs(moments["sharp"].skewness + 0.9) < 0.25
for moment in moments.values():
    assert abs(moment.rms_height / 1e-3 - 1) < 1e-12
sharp, middle, blunt = contacts.values()
assert sharp.contact_area_fraction < middle.contact_area_fraction < blunt.contact_area_fraction
assert sharp.mean_contact_pressure > middle.mean_contact_pressure > blunt.mean_contact_pressure

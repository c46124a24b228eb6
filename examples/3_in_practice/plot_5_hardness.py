r"""
Plastic contact: a hardness
===========================

A metal flows where the pressure reaches its hardness :math:`p_H`, about three times the yield stress.
``hardness=`` bounds the pressure, :math:`0 \le p \le p_H`: the surface is flattened where the bound is
reached, and the real contact grows.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

height = asp.self_affine((256, 256), 0.8, 50e-6, 3e-6, rms_height=0.1e-6, seed=3, length=100e-6)
steel = asp.Solid(young=210e9, poisson=0.3)
load = 100e6
elastic = asp.solve_contact(height, steel, 100e-6, mean_pressure=load)
contact = asp.solve_contact(height, steel, 100e-6, mean_pressure=load, hardness=4.5e9)
print(
    f"elastic: {100 * elastic.contact_area_fraction:.2f} % in contact, "
    f"at most {elastic.maximum_pressure / 1e9:.1f} GPa"
)
print(
    f"plastic: {100 * contact.contact_area_fraction:.2f} %, "
    f"{100 * contact.plastic_load:.0f} % of the load at 4.5 GPa"
)

# %%
# Pressure without and with the hardness, and the depth by which the surface is flattened.
figure, axes = plt.subplots(1, 3, figsize=(11, 3.2), layout="compressed")
window = {"x": (0, 50e-6), "y": (0, 50e-6), "unit_system": "SI"}
asp.views.plot_pressure(elastic, axes=axes[0], **window)
asp.views.plot_pressure(contact, axes=axes[1], **window)
axes[0].set_title("elastic")
axes[1].set_title("hardness 4.5 GPa")
depth = np.where(contact.plastic_depth > 0, contact.plastic_depth * 1e9, np.nan)
image = axes[2].imshow(depth[:128, :128], origin="lower", extent=(0, 50, 0, 50), cmap="viridis_r")
axes[2].set(title="plastic depth", xlabel="x (µm)", ylabel="y (µm)")
figure.colorbar(image, ax=axes[2], label="plastic depth (nm)")
plt.show()

# %%
# The softer the surface, the more of the contact is plastic; in the soft limit its area is load / hardness.
shares = []
for hardness in (20e9, 10e9, 4.5e9, 2e9, 1e9, 0.5e9):
    found = asp.solve_contact(height, steel, 100e-6, mean_pressure=load, hardness=hardness)
    shares.append((hardness, found.contact_area_fraction, found.plastic_load))
hardness, area, plastic = np.array(shares).T
figure, axis = plt.subplots(figsize=(5, 3.5), layout="compressed")
axis.loglog(hardness / 1e9, area, "o-", label="real contact")
axis.loglog(hardness / 1e9, load / hardness, "k--", label="load / hardness")
axis.axhline(elastic.contact_area_fraction, color="C1", label="elastic")
axis.set(xlabel="hardness (GPa)", ylabel="fraction of the area")
axis.legend()
plt.show()

# %%
# **Check**: after this load the surface is flattened by the plastic depth. Pressed elastically under the same
# load, the flattened surface bears exactly the same pressure: the second loading is elastic.
again = asp.solve_contact(contact.flattened_height(), steel, 100e-6, mean_pressure=load)
error = np.linalg.norm(again.pressure - contact.pressure) / np.linalg.norm(contact.pressure)
assert error < 1e-5
assert np.all(np.diff(area) > 0)
assert np.all(np.diff(plastic) > 0)
assert abs(area[-1] * hardness[-1] / load - 1) < 0.02

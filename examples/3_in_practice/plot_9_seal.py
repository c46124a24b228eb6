r"""
A seal: what leaks through the gap
==================================

A rough steel ring is pressed into rubber. ``percolation`` finds out whether a path through the gap is open
and how narrow it is at its narrowest point, and ``film_flow`` computes the flow through it (with ``pip
install "asperity[flow]"``).
"""

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LogNorm

import asperity as asp

length, viscosity, fall = 200e-6, 1e-3, 1e5  # m, Pa s (water), Pa
height = asp.self_affine((128, 128), 0.8, 1e-4, 12.5e-6, rms_height=1e-6, seed=1, length=length)
rubber = asp.Solid(young=10e6, poisson=0.49)
pressures = np.array([0.05, 0.1, 0.2, 0.3]) * 1e6
contacts = list(asp.solve_load_path(height, rubber, length, mean_pressures=pressures))
paths = [asp.contact.percolation(contact) for contact in contacts]
flows = [asp.contact.film_flow(contact, viscosity, fall, "x") for contact in contacts]
for contact, path, flow in zip(contacts, paths, flows, strict=True):
    print(
        f"{contact.mean_pressure / 1e6:.2f} MPa: contact {100 * contact.contact_area_fraction:.0f} %, "
        f"constriction {path.constriction[1] * 1e9:.0f} nm, leakage {flow.flow_rate * 1e18:.4g} µm³/s"
    )

# %%
# The pressure closes the path long before the contact is complete.
figure, axes = plt.subplots(1, 2, figsize=(9, 3.8), layout="compressed")
edges = (0, length * 1e6, 0, length * 1e6)
for axis, flow, pressure in zip(axes, (flows[0], flows[-1]), (pressures[0], pressures[-1]), strict=True):
    flux = np.hypot(*flow.flux)
    flux = np.ma.masked_where(np.isnan(flow.pressure), flux / flux.mean())
    image = axis.imshow(flux, origin="lower", extent=edges, norm=LogNorm(1e-3, 100))
    axis.set_facecolor("black")
    axis.set(title=f"{pressure / 1e6:.2f} MPa", xlabel="x (µm)", ylabel="y (µm)")
figure.colorbar(image, ax=axes, label="flux over the mean flux")
plt.show()

# %%
# **Check**: sections carry the same flow, which falls with the load as the constriction does. For flow
# across a wave the gaps are in series, 1/(mean of 1/g³), and along it they are parallel, mean of g³: a
# cylinder against a flat, whose gap is known beside the contact, shows the second.
rates = np.array([flow.flow_rate for flow in flows])
assert max(flow.conservation_error for flow in flows) < 1e-4
assert np.all(np.diff(rates) < 0)
assert np.all(np.diff([path.constriction[1] for path in paths]) < 0)
roller = asp.surface.add_cylinder(np.zeros((64, 64)), length, 1e-3, axis="x")
line = asp.solve_contact(roller, rubber, length, contact_area_fraction=0.3)
along = asp.contact.film_flow(line, viscosity, fall, "x")
gap = np.where(line.pressure > 0, 0, line.gap)
assert abs(along.flow_rate / (np.mean(gap**3) * fall / (12 * viscosity)) - 1) < 1e-6

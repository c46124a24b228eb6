r"""
Sections, boxes and fields for other programs
=============================================

``stress_section`` is a vertical cut, ``stress_box`` a block of the solid on one grid. Both are datasets of
xarray. A box is computed plane by plane, so that it may be larger than the memory.
"""

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import xarray as xr

import asperity as asp

solid = asp.Solid(young=210e9, poisson=0.3)
height = asp.self_affine((128, 128), 0.8, 0.05e-3, 12.5e-6, rms_height=0.2e-6, seed=3, length=0.2e-3)
contact = asp.solve_contact(height, solid, 0.2e-3, mean_pressure=50e6)

# %%
# A section through the maximum pressure: as a dataset, and with ``plot_section``.
section = asp.stress_section(contact, along="x", depths=np.linspace(0, 20e-6, 41), fields=("von_mises", "xz"))
print(f"maximum |σ_xz| in it: {1e-6 * float(abs(section['xz']).max()):.0f} MPa")
figure, axes = plt.subplots(2, 1, figsize=(8, 5), layout="compressed")
for axis, field in zip(axes, ("xz", "von_mises"), strict=True):
    asp.views.plot_section(contact, depth=20e-6, field=field, axes=axis, unit_system="SI")
plt.show()

# %%
# A plane of constant depth.
figure, axes = plt.subplots(figsize=(4.6, 3.8), layout="compressed")
asp.views.plot_plane(contact, depth=5e-6, field="maximum_shear", axes=axes, unit_system="SI")
plt.show()

# %%
# A box below a quarter of the cell, written as NetCDF. For ParaView, ``asperity export`` writes VTK image
# data from the result files of the command line.
depths = np.linspace(0, 30e-6, 16)
box = asp.stress.stress_box(contact, depths, y=(0, 0.1e-3), x=(0, 0.1e-3), fields=("zz", "von_mises"))
with tempfile.TemporaryDirectory() as folder:
    path = Path(folder) / "box.nc"
    box.dataset().to_netcdf(path)
    with xr.open_dataset(path) as stored:
        block = stored.load()
print(block.sizes)

# %%
# **Check**: the surface bears the contact pressure, σ_zz = −p; every plane bears the whole load
# (equilibrium); and the box holds what the section holds where they meet.
whole = list(asp.stress_planes(contact, depths, fields=("zz",)))
assert np.abs(whole[0].fields["zz"][0] + contact.pressure).max() < 1e-5 * contact.maximum_pressure
for plane in whole:
    assert abs(plane.fields["zz"].mean() / -contact.mean_pressure - 1) < 1e-5
cut = asp.stress_section(contact, along="x", at=float(block["y"][7]), depths=depths).isel(poisson=0)
np.testing.assert_allclose(
    block["von_mises"].isel(poisson=0, y=7),
    cut["von_mises"].isel(x=slice(0, block.sizes["x"])),
    atol=1e-5 * contact.maximum_pressure,
)

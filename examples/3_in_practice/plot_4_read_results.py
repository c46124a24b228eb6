r"""
Reading result files
====================

``asperity run`` and every rule of the study write NetCDF files, and so does ``write_result``. ``read_result``
checks their fingerprint; ``xarray.open_dataset`` and ``ncdump`` read them too. The command line, here called
in this process, draws and exports them; in a shell the same words follow ``asperity``.
"""

import json
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import asperity as asp
from asperity.cli.main import main as asperity

folder = tempfile.TemporaryDirectory()
contact, stress, table, field = (
    str(Path(folder.name) / name) for name in ("contact.nc", "stress.nc", "peaks.csv", "field.vti")
)
height = asp.self_affine((128, 128), 0.8, 50e-6, 12.5e-6, rms_height=0.2e-6, seed=1, length=200e-6)
solved = asp.solve_contact(height, asp.Solid(210e9, 0.3), 200e-6, contact_area_fraction=0.1)
solved.to_netcdf(contact)
found = asp.analyse_stress(solved, poisson=[0.0, 0.3, 0.5]).assign_attrs(unit_system="SI")
asp.write_result(found, stress, "Stress under a rough surface", {"seed": 1})

# %%
# What a file holds, and from which settings it was made.
pressed = asp.read_result(contact)
pressed

# %%
settings = json.loads(pressed.attrs["settings"])
print(json.dumps(settings, indent=2))

# %%
# Pictures are made from the datasets.
analysed = asp.read_result(stress)
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="compressed")
asp.views.plot_gap(pressed, axes=left)
asp.views.plot_peaks(analysed, "von_mises", 0.3, axes=right)
plt.show()

# %%
# A table for pandas or Excel, and a field for ParaView.
asperity(f"export {stress} --peaks {table}".split())
asperity(f"export {contact} --field von_mises:0-20um {field}".split())
rows = pd.read_csv(table)
rows[rows["quantity"] == "von_mises"].head()

# %%
# **Check**: the pressure in the file fulfils the conditions of contact, evaluated anew from height and solid,
# and the table holds the peaks of the dataset.
pressure = pressed["pressure"].values
certificate = asp.contact.verify_contact(
    height, pressure, asp.Solid(210e9, 0.3), 200e-6, mean_pressure=pressure.mean()
)
assert certificate.worst < 1e-3
found = asp.stress.select_peaks(analysed, "von_mises", poisson=0.3)
same = rows[(rows["quantity"] == "von_mises") & (rows["poisson"] == 0.3)]
assert len(same) == found.sizes["peak"]
assert abs(1e6 * same.iloc[0, 4] / float(found["peak_value"].max()) - 1) < 1e-5
assert Path(field).stat().st_size > 128 * 128 * 4
folder.cleanup()

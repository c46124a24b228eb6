r"""
Reading results of the command line and of a study
==================================================

Every command and every rule of the study writes one NetCDF file. ``read_result`` checks its fingerprint;
``xarray.open_dataset`` and ``ncdump`` read it too. Here the command line makes the files of a small
calculation, in this process; in a shell the same words follow ``asperity``.
"""

import json
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import pandas as pd

import asperity as asp
from asperity.cli.main import main as asperity

folder = tempfile.TemporaryDirectory()
surface, contact, stress, table, field = (
    str(Path(folder.name) / name)
    for name in ("surface.nc", "contact.nc", "stress.nc", "peaks.csv", "field.vti")
)
commands = (
    "surface --points 128 --hurst 0.8 --wavelength-long 0.25 --wavelength-short 0.0625 --rms-height 0.001 "
    f"--seed 1 --out {surface}",
    f"solve {surface} --poisson 0.33 --area-fraction 0.1 --out {contact}",
    f"stress {contact} --poisson 0 0.33 0.5 --out {stress}",
)
for command in commands:
    asperity(command.split())

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
asp.views.plot_peaks(analysed, "von_mises", 0.33, axes=right)
plt.show()

# %%
# A table for pandas or Excel, and a field for ParaView.
asperity(f"export {stress} --peaks {table}".split())
asperity(f"export {contact} --field von_mises:0-0.1 {field}".split())
rows = pd.read_csv(table)
rows[rows["quantity"] == "von_mises"].head()

# %%
# **Check**: the pressure in the file fulfils the conditions of contact, evaluated anew from surface and
# solid, and the table holds the peaks of the dataset.
height = asp.read_result(surface)["height"].values
solid = asp.Solid(young=1 - 0.33**2, poisson=0.33, height=1.0)  # E* = 1, as in the files of the study
certificate = asp.contact.verify_contact(
    height, pressed["pressure"].values, solid, mean_pressure=pressed["pressure"].values.mean()
)
assert certificate.worst < 1e-3
found = asp.stress.select_peaks(analysed, "von_mises", poisson=0.33)
same = rows[(rows["quantity"] == "von_mises") & (rows["poisson"] == 0.33)]
assert len(same) == found.sizes["peak"]
assert abs(same.iloc[0, 4] / float(found["peak_value"].max()) - 1) < 1e-5
assert Path(field).stat().st_size > 128 * 128 * 4
folder.cleanup()

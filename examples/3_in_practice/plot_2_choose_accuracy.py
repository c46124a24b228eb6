r"""
Choosing the accuracy
=====================

The largest error is nearly always the discretisation error: how many nodes lie on the shortest wavelength
λ_s. A seed is the same surface at every resolution, so that refining the grid shows the error. ``asperity
plan`` predicts it beforehand from errors that were measured, with the time and the memory.
"""

import contextlib
import io

import matplotlib.pyplot as plt
import numpy as np
import yaml

import asperity as asp
from asperity.cli.main import main as asperity

solid = asp.Solid(young=1.0, poisson=0.33)
wavelength_short = 1 / 16


def highest_peaks(nodes: int) -> float:
    """The 99th percentile of the von Mises peaks with a number of nodes on the shortest wavelength."""
    points = round(nodes / wavelength_short)
    height = asp.self_affine((points, points), 0.8, 1 / 4, wavelength_short, rms_height=1e-3, seed=1)
    contact = asp.solve_contact(height, solid, contact_area_fraction=0.1)
    depths = asp.stress.depth_grid(contact.grid, height=0.1, spacing=0.25)
    stress = asp.analyse_stress(contact, depths, quantities=("von_mises",), tolerance=1e-4)
    return float(
        asp.stress.select_peaks(stress, "von_mises", selection="under_contact")["peak_value"].quantile(0.99)
    )


nodes = np.array([4, 6, 8, 12, 24])
values = np.array([highest_peaks(number) for number in nodes])
errors = np.abs(values / values[-1] - 1)[:-1]

figure, axes = plt.subplots(figsize=(5.5, 3.6), layout="compressed")
axes.loglog(nodes[:-1], 100 * errors, "o-")
axes.set_xticks([], minor=True)
axes.set_xticks(nodes[:-1], nodes[:-1])
axes.set(xlabel="nodes on λ_s", ylabel="error of the 99th percentile (%)")
plt.show()

# %%
# The plan for surfaces of this kind and an error of at most 10 % of this very surface. In a shell the same
# words follow ``asperity``; here the text is kept, because its end is YAML: settings for a study, or for
# the calls above.
spectrum = "{hurst: 0.8, wavelength_long: 0.25, wavelength_short: 0.0625}"
text = io.StringIO()
with contextlib.redirect_stdout(text):
    asperity(["plan", spectrum, "--error", "0.10", "--output", "von_mises_p99", "--one-surface"])
print(text.getvalue())

# %%
# **Check**: the error falls with the grid, and with the number of nodes that was proposed it is below 10 %.
settings = yaml.safe_load(text.getvalue().split("to lay over a configuration:")[1])
proposed = settings["surfaces"]["surface"]["points"] * wavelength_short
error = np.interp(proposed, nodes[:-1], errors)
print(f"proposed: {proposed:g} nodes on λ_s, where the error is {100 * error:.2g} %")
assert errors[0] > errors[1] > errors[2:].max()
assert error < 0.10

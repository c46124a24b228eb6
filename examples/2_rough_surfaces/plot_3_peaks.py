r"""
Peaks of the stress and their distribution
==========================================

A peak is a point of the solid with a higher stress than its 26 neighbours. The peaks of several seeds
are pooled: one seed is one random surface, and the band comes from a bootstrap over whole seeds.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

solid = asp.Solid(young=1.0, poisson=0.33)
depths = asp.stress.depth_grid(asp.Grid((192, 192)), height=0.25)
stresses, gradients = [], []
for seed in range(1, 5):
    height = asp.self_affine((192, 192), 0.8, 1 / 4, 1 / 24, rms_height=1e-3, seed=seed)
    contact = asp.solve_contact(height, solid, contact_area_fraction=0.1)
    stresses.append(
        asp.analyse_stress(
            contact, depths, poisson=[0.0, 0.33, 0.5], quantities=("von_mises",), tolerance=1e-4
        )
    )
    gradients.append(contact.gradient_rms_contact)

# %%
# Values, depths and positions of the peaks are a dataset, or a table of pandas.
found = asp.stress.select_peaks(stresses[0], "von_mises", poisson=0.33, selection="under_contact")
table = found.to_dataframe()
table.nlargest(5, "peak_value")

# %%
# On the left the peaks of one surface over depth, on the right the probability density of all four, with
# its band.
pooled = asp.stress.pool_peaks(stresses, gradients, bins=25).sel(
    selection="under_contact", quantity="von_mises"
)
edges = pooled["bin_edge"].values
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="compressed")
asp.views.plot_peaks(stresses[0], "von_mises", 0.33, axes=left)
for colour, poisson in zip(("C0", "C1", "C2"), (0.0, 0.33, 0.5), strict=True):
    density = pooled.sel(poisson=poisson)
    low, high = density["peak_density_low"], density["peak_density_high"]
    right.stairs(density["peak_density"], edges, color=colour, label=f"ν = {poisson:g}")
    right.stairs(high, edges, baseline=low, fill=True, color=colour, alpha=0.2)
right.set(xlabel=r"von Mises peak/(E* $\bar g_r$)", ylabel="probability density")
right.legend()
plt.show()

# %%
# The correlation of the von Mises stress within a plane falls over about a wavelength.
(plane,) = asp.stress_planes(contact, [1 / 48])
lag, covariance = asp.stress.autocorrelation(plane.fields["von_mises"][0], plane.grid)
print(f"falls to half at a distance of {np.interp(-0.5, -covariance / covariance[0], lag):.3f} L")

# %%
# **Check**: every density integrates to one, the covariance at no distance is the variance of the plane, and
# an incompressible solid has the smaller and deeper peaks.
for poisson in (0.0, 0.33, 0.5):
    assert abs(np.sum(pooled["peak_density"].sel(poisson=poisson) * np.diff(edges)) - 1) < 1e-12
field = plane.fields["von_mises"][0]
assert abs(covariance[0] / field.var() - 1) < 1e-5
compressible, incompressible = (
    asp.stress.select_peaks(stresses[0], "von_mises", nu, "under_contact") for nu in (0.0, 0.5)
)
assert incompressible["peak_value"].quantile(0.9) < compressible["peak_value"].quantile(0.9)
assert incompressible["peak_depth"].median() > compressible["peak_depth"].median()

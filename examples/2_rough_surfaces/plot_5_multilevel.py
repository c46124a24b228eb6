"""
Means over surfaces: many coarse grids and few fine ones
========================================================

The rms gradient of a rough surface over its true contact scatters from surface to surface. Its mean takes
many surfaces to know well, and on a fine grid each of them is expensive. One seed is the same surface on
every grid, so that the fine grid has to supply the small difference from a coarse grid only: the multilevel
Monte Carlo method. The gradient of the whole surface needs no contact at all, and helps too.
"""

import time
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.accuracy.multilevel import bias, multilevel_mean

band = {"hurst": 0.8, "wavelength_long": 0.5, "wavelength_short": 1 / 16, "rms_height": 0.01}
solid = asp.Layer(young=1.0, poisson=0.0)


def contact_gradient(points, seed):
    """Root-mean-square gradient over the true contact of 10 %, on a grid of points² nodes."""
    height = asp.self_affine((points, points), seed=seed, **band)
    return asp.solve(height, solid, area_fraction=0.1).gradient_rms_contact


def surface_gradient(points, seed):
    """Root-mean-square gradient of the whole surface."""
    return asp.roughness_parameters(asp.self_affine((points, points), seed=seed, **band)).rms_gradient


# %%
# Levels: the surface alone, then grids of 4, 8 and 16 nodes on the shortest wavelength with fewer and fewer
# seeds. The seeds of a grid are the first ones of the coarser grid.
levels = {
    "surface alone": (surface_gradient, 40, 400),
    "4 nodes": (contact_gradient, 64, 64),
    "8 nodes": (contact_gradient, 128, 16),
    "16 nodes": (contact_gradient, 256, 6),
}
samples = []
for name, (compute, points, seeds) in levels.items():
    begin = time.process_time()
    samples.append(np.array([compute(points, seed) for seed in range(1, seeds + 1)]))
    print(f"{name:14}{seeds:4} seeds, {time.process_time() - begin:5.2f} s")

# %%
# The estimate on the finest grid, its standard error, and what vanishing grid spacing would add to it.
found = multilevel_mean(samples)
plain = multilevel_mean(samples[-1:])
shift = bias((4, 8, 16), samples[1:])
print(f"multilevel  {found.value:.4f} ± {found.error:.4f}; the grid adds {shift.value:+.4f}")
print(f"plain       {plain.value:.4f} ± {plain.error:.4f} with {len(samples[-1])} seeds of the finest grid")

figure, axis = plt.subplots(figsize=(5, 3.4), layout="compressed")
for name, values in list(zip(levels, samples, strict=True))[1:]:
    axis.plot(samples[0][: len(values)], values, "o", ms=4, label=f"{name}, {len(values)} seeds")
axis.set(xlabel="rms gradient of the surface", ylabel="rms gradient over the contact")
axis.legend()
plt.show()

# %%
# **Check**: consecutive grids are so well correlated that few seeds give their difference; the fine surfaces,
# helped by the coarse ones, tell the mean far better than by themselves; and both means agree.
correlations = [np.corrcoef(coarse[: len(fine)], fine)[0, 1] for coarse, fine in pairwise(samples)]
assert min(correlations[1:]) > 0.98
assert correlations[0] > 0.7
assert found.error < 0.4 * plain.error
low, high = plain.interval(0.99)
assert low < found.value < high

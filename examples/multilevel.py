"""
Error bars for less work: many coarse grids and few fine ones
=============================================================

The rms gradient of a rough surface over its true contact scatters from surface to surface. Its mean over
surfaces takes many contacts to know well, and on a fine grid each of them is expensive. One seed is the same
surface on every grid, so that the fine grid has to supply the small difference from a coarse grid only: the
multilevel Monte Carlo method. The gradient of the whole surface needs no contact at all, and helps too.
"""

import time
from itertools import pairwise

import matplotlib.pyplot as plt
import numpy as np

import asperity
from asperity.accuracy.multilevel import bias, multilevel_mean

BAND = {"hurst": 0.8, "wavelength_long": 0.5, "wavelength_short": 1 / 16, "rms_height": 0.01}
HALF_SPACE = asperity.Layer(young=1.0, poisson=0.0)


def gradient(points, seed):
    """Root-mean-square gradient over the true contact of 10 %, on a grid of points² nodes."""
    height = asperity.self_affine((points, points), seed=seed, **BAND)
    return asperity.solve(height, HALF_SPACE, area_fraction=0.1).gradient_rms_contact


def surface_gradient(seed):
    """Root-mean-square gradient of the whole surface."""
    return asperity.roughness_parameters(asperity.self_affine((40, 40), seed=seed, **BAND)).rms_gradient


# %%
# Levels: the surface alone with 400 seeds, then grids of 4, 8 and 16 nodes on the shortest wavelength with
# fewer and fewer seeds. The seeds of a grid are the first ones of the coarser grid.
levels = {"surface alone": (surface_gradient, 400)}
for points, seeds in ((64, 64), (128, 16), (256, 6)):
    levels[f"{points // 16} nodes"] = (lambda seed, points=points: gradient(points, seed), seeds)

samples, seconds = [], []
gradient(64, 0)  # compiles
for compute, seeds in levels.values():
    begin = time.process_time()
    samples.append(np.array([compute(seed) for seed in range(1, seeds + 1)]))
    seconds.append((time.process_time() - begin) / seeds)

# %%
# The estimate on the finest grid, its standard error, and what vanishing grid spacing would add to it.
found = multilevel_mean(samples)
shift = bias((4, 8, 16), samples[1:])
plain = multilevel_mean(samples[-1:])
print(f"multilevel  {found.value:.4f} ± {found.error:.4f}; the grid adds {shift.value:+.4f}")
print(f"plain       {plain.value:.4f} ± {plain.error:.4f} with {len(samples[-1])} seeds of the finest grid")

# The six fine surfaces, helped by coarse ones, tell the mean far better than by themselves; both means agree.
assert found.error < 0.4 * plain.error
low, high = plain.interval(0.99)
assert low < found.value < high

# %%
# Consecutive grids are so well correlated that few seeds give their difference.
correlations = [np.corrcoef(coarse[: len(fine)], fine)[0, 1] for coarse, fine in pairwise(samples)]
print("correlations", *(f"{correlation:.4f}" for correlation in correlations))
assert min(correlations[1:]) > 0.98
assert correlations[0] > 0.7

fig, axis = plt.subplots(figsize=(5, 3.2), layout="constrained")
for name, values in list(zip(levels, samples, strict=True))[1:]:
    axis.plot(samples[0][: len(values)], values, "o", ms=3, label=f"{name}, {len(values)} seeds")
axis.set(xlabel="rms gradient of the surface", ylabel="rms gradient over the contact")
axis.legend()
plt.show()

r"""
Several maps of one surface
===========================

One map does not show how positions of a surface differ, but four maps do: ``asp.pool`` gives every number as
its mean with a 95 % interval, from the differences between positions and from the pixels. Here each map is a
cut-out of a larger surface with a known contact, so that the result can be checked.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

edge, points = 80e-6, 64
whole = asp.self_affine((256, 256), 0.8, 40e-6, 10e-6, rms_height=1.5e-7, seed=4, length=4 * edge)
steel = asp.Body(young=210e9, poisson=0.3, yield_stress=2e9)
positions = [(0, 0), (64, 128), (128, 32), (192, 192)]
maps = [
    asp.HeightMap(-whole[y : y + points, x : x + points], (edge, edge), name=f"position {number}")
    for number, (y, x) in enumerate(positions, 1)
]
answers = [asp.run({"file": each, "detrend": "none"}, steel, mean_pressure=200e6) for each in maps]
sample = asp.pool(answers)
print(sample)

# %%
# Peaks of the von Mises stress above a stress, per nominal area: the mean of the maps, and each of them.
peaks = sample.peaks_per_area().query("quantity == 'von_mises'")
figure, axis = plt.subplots(figsize=(5.5, 3.8), layout="compressed")
for name in sample.names:
    axis.plot(peaks["stress_Pa"] / 1e9, peaks[f"map_{name}"], "C7", lw=0.8)
axis.plot(peaks["stress_Pa"] / 1e9, peaks["per_mm2"], "C0", lw=2)
axis.axvline(2.0, color="C1", ls=":")
axis.set(yscale="log", xlabel="von Mises stress (GPa)", ylabel="peaks above it (1/mm²)")
plt.show()

# %%
# **Check**: the larger surface, pressed as a whole, is within the interval of the maps: its contact area and
# its volume above yield per area. The interval is Student's :math:`t s / \sqrt{n}`, with the pixels.
all_of_it = asp.HeightMap(-whole, (4 * edge, 4 * edge), periodic=True, name="whole")
truth = asp.pool([asp.run(all_of_it, steel, mean_pressure=200e6)])
for quantity in ("contact area fraction", "volume above yield per area"):
    found, known = sample[quantity], truth[quantity].best
    print(f"{quantity}: {found.best:.4g} ± {found.error:.2g}, the whole surface {known:.4g}")
    assert abs(found.best - known) < found.error
areas = [answer["contact area fraction"].best for answer in answers]
expected = 3.182 * np.std(areas, ddof=1) / 2
between = sample["contact area fraction"].errors["between measurement positions"]
assert abs(between / expected - 1) < 1e-3

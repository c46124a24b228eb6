r"""
Maximum stress of an area that was not measured
===============================================

The maximum stress of a map holds for its few square micrometres. A larger area has a higher one:
peaks above a threshold follow a generalised Pareto distribution, from which ``Sample.maximum`` predicts it,
with an interval, up to a hundred times the area of the maps.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

edge, cells, load = 40e-6, 4, {"mean_pressure": 300e6}
steel = asp.Body(young=210e9, poisson=0.3, hardness=6e9)


def cell(seed):
    """Heights of a cell of the surface."""
    return asp.self_affine((64, 64), 0.8, edge / 2, edge / 8, rms_height=1e-7, seed=seed, length=edge)


maps = [asp.HeightMap(cell(seed), (edge, edge), periodic=True) for seed in range(cells)]
sample = asp.pool([asp.run(each, steel, **load) for each in maps])
times = np.array([1, 5, 20, 100])
found = [sample.maximum(n * cells * edge**2).set_index("quantity").loc["von_mises"] for n in times]

figure, axis = plt.subplots(figsize=(5.5, 3.8), layout="compressed")
axis.fill_between(times, *([row[end] / 1e9 for row in found] for end in ("low_Pa", "high_Pa")), alpha=0.3)
axis.plot(times, [row["value_Pa"] / 1e9 for row in found])
axis.set(xscale="log", xlabel="area over the area of the maps", ylabel="maximum von Mises stress (GPa)")
plt.show()

# %%
# **Check**: the maximum stress of five times as many other cells is within the interval that was predicted.
others = 0.0
for seed in range(100, 100 + 5 * cells):
    contact = asp.solve_contact(cell(seed), asp.Solid(steel.young, steel.poisson), edge, hardness=6e9, **load)
    stress = asp.analyse_stress(contact, quantities=("von_mises",), tolerance=1e-3)
    others = max(others, float(stress["peak_value"].max()))
low, high = found[1]["low_Pa"], found[1]["high_Pa"]
print(f"predicted {low / 1e9:.2f} to {high / 1e9:.2f} GPa, largest of 20 other cells {others / 1e9:.2f} GPa")
assert low < others < high
assert all(np.diff([row["value_Pa"] for row in found]) > 0)

r"""
A roller without ends
=====================

A map of a roller continues along its axis and ends across it. A free boundary cuts it there instead, which
loads its ends more than its middle, and a periodic cell puts other rollers beside it, which confines it.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.reference.hertz import LineHertz, von_mises

solid = asp.Solid(young=1.0, poisson=0.3)
grid = asp.Grid((96, 128), (0.75, 1.0), mirrored=True)  # y along the axis
roller = asp.surface.add_cylinder(np.zeros(grid.shape), grid.length, radius=5.0, axis="y")
load_per_length = 0.02
hertz = LineHertz.from_load(load_per_length, 5.0, solid.effective_modulus)

# %%
# Under the same load per length the free ends carry more, and their neighbours less.
boundaries = {
    "periodic along y, free along x": ("periodic", "free"),
    "free": "free",
    "periodic": "periodic",
}
contacts = {
    name: asp.solve_contact(
        roller,
        solid,
        grid.length if boundary == "free" else grid,
        force=load_per_length * grid.length[0],
        boundary=boundary,
    )
    for name, boundary in boundaries.items()
}
depth = 0.7042 * hertz.half_width
largest = von_mises(hertz.stress(0.0, depth, solid.poisson))
stress = {
    name: next(asp.stress_planes(contact, [depth], tolerance=0)).fields["von_mises"][0].max(axis=1)
    for name, contact in contacts.items()
}

y = grid.coordinates()[0]
figure, (left, right) = plt.subplots(1, 2, figsize=(8, 3.4), layout="compressed", sharex=True)
for name, contact in contacts.items():
    left.plot(y, contact.pressure.max(axis=1) / hertz.maximum_pressure, label=name)
    right.plot(y, stress[name] / hertz.maximum_pressure)
left.set(xlabel="position along the axis/edge across", ylabel="maximum pressure/p₀ of Hertz", ylim=(0, 2.5))
right.set(xlabel="position along the axis/edge across", ylabel="von Mises stress at 0.704 b/p₀")
left.legend()
plt.show()

# %%
# The displacement beside a line of load falls with the logarithm of the distance and has no limit far away.
# The approach is measured from the surface at a distance of the edge of the map across the axis.
line = contacts["periodic along y, free along x"]
distance = grid.length[1]
expected = (
    load_per_length / (np.pi * solid.effective_modulus) * (1 + 2 * np.log(2 * distance / hertz.half_width))
)
print(f"approach {line.approach - roller.min():.4f}, closed form {expected:.4f}")

# %%
# **Check**: the roller is a line contact everywhere; the ends of the free map are not.
assert abs(line.maximum_pressure / hertz.maximum_pressure - 1) < 0.003
assert np.abs(stress["periodic along y, free along x"] / largest - 1).max() < 0.003
assert np.ptp(line.pressure, axis=0).max() < 1e-6 * line.maximum_pressure
assert contacts["free"].maximum_pressure > 1.2 * hertz.maximum_pressure
assert stress["periodic"].max() > 1.01 * largest
assert abs((line.approach - roller.min()) / expected - 1) < 0.002

r"""
A thin layer against the half-space
===================================

A soft layer bonded to a rigid base, such as a rubber coating or cartilage, is stiffer than a half-space of
the same material: the base is felt as soon as the contact is as wide as the layer is high. The reference is
an independent solution for the paraboloid by an integral equation of Fredholm's kind.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.reference.bonded_layer import BondedLayer
from asperity.reference.hertz import Hertz

young, poisson, radius = 1.0, 0.33, 10.0
grid = asp.Grid((128, 128), 1.0)
height = asp.surface.add_sphere(np.zeros(grid.shape), grid, radius)
half_space = asp.Solid(young, poisson)

# %%
# The same contact radius is pressed into layers of different heights. At these heights the repeated
# contacts of the periodic cell do not influence each other, so that the solution for a single contact
# applies.
contact_radius = 0.12
hertz = Hertz(contact_radius, radius, half_space.effective_modulus)
heights = (0.06, 0.1, 0.15)
ratios, expected = [], []
for layer_height in heights:
    single = BondedLayer(layer_height, poisson, half_space.effective_modulus).paraboloid(
        contact_radius, radius
    )
    layer = asp.Solid(young, poisson, height=layer_height, bottom="bonded")
    contact = asp.solve_contact(height, layer, approach=height.min() + single.approach)
    ratios.append(contact.force / hertz.load)
    expected.append(single.load / hertz.load)
    print(f"height {layer_height / contact_radius:.2f} a: load {ratios[-1]:.3f} times that of Hertz")

# %%
figure, axes = plt.subplots(figsize=(6, 3.6), layout="compressed")
curve = np.geomspace(0.4, 6, 25)
loads = [
    BondedLayer(value * contact_radius, poisson, half_space.effective_modulus)
    .paraboloid(contact_radius, radius)
    .load
    for value in curve
]
axes.plot(curve, np.array(loads) / hertz.load, label="integral equation")
axes.plot(np.array(heights) / contact_radius, ratios, "o", label="computed")
axes.axhline(1, color="0.6", linestyle=":", label="half-space (Hertz)")
axes.set(xlabel="height of the layer/a", ylabel="load/load of Hertz, same contact radius")
axes.legend()
plt.show()

# %%
# **Check**: the load, to the discretisation error; thinner layers are stiffer.
np.testing.assert_allclose(ratios, expected, rtol=0.005)
assert ratios[0] > ratios[1] > ratios[2] > 1

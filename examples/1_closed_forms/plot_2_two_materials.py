r"""
Two elastic bodies: steel on bronze
===================================

Both bodies carry the same pressure, and their displacements add up: the contact is the same as on one solid
with :math:`1/E^* = (1 - \nu_1^2)/E_1 + (1 - \nu_2^2)/E_2`. The stress inside differs from body to body,
because it depends on Poisson's ratio.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.reference.hertz import Hertz

steel, bronze = asp.Solid(young=210e9, poisson=0.30), asp.Solid(young=110e9, poisson=0.34)
pair = asp.TwoBodies(lower=bronze, upper=steel)
radius, force = 10e-3, 20.0
grid = asp.Grid((96, 96), 0.3e-3)
ball = asp.surface.add_sphere(np.zeros(grid.shape), grid, radius)
contact = asp.solve_contact(ball, pair, grid.length, force=force, boundary="free")
hertz = Hertz.from_load(force, radius, pair.effective_modulus)
print(f"E* of the pair {pair.effective_modulus / 1e9:.1f} GPa")
print(
    f"maximum pressure {contact.maximum_pressure / 1e6:.0f} MPa, Hertz {hertz.maximum_pressure / 1e6:.0f} MPa"
)

# %%
# ``in_body`` gives the body whose stress is asked for. The curve is Huber's solution on the axis.
depths = np.linspace(0.02, 2.0, 34) * hertz.contact_radius
figure, axes = plt.subplots(figsize=(6, 3.6), layout="compressed")
largest = {}
for name, layer in (("lower", bronze), ("upper", steel)):
    planes = asp.stress_planes(contact.in_body(name), depths)
    profile = np.array([plane.fields["von_mises"].max() for plane in planes])
    on_axis = hertz.stress(0.0, depths, layer.poisson).von_mises
    (line,) = axes.plot(
        depths / hertz.contact_radius, profile / 1e6, ".", label=f"{name}, ν = {layer.poisson}"
    )
    axes.plot(depths / hertz.contact_radius, on_axis / 1e6, color=line.get_color())
    largest[name] = profile.max(), on_axis.max()
axes.set(xlabel="depth/a", ylabel="maximum von Mises stress (MPa)")
axes.legend()
plt.show()

# %%
# **Check**: the pressure is Hertz's for the pair, the stress follows from the Poisson's ratio of the
# body, and exchanging the bodies changes no pressure.
assert abs(contact.maximum_pressure / hertz.maximum_pressure - 1) < 0.003
for found, expected in largest.values():
    assert abs(found / expected - 1) < 0.005
assert largest["lower"][0] < largest["upper"][0]
exchanged = asp.solve_contact(ball, asp.TwoBodies(steel, bronze), grid.length, force=force, boundary="free")
assert np.array_equal(exchanged.pressure, contact.pressure)

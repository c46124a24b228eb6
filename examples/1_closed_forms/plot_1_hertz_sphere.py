r"""
Ball on a flat: Hertz
=====================

A steel ball of 10 mm radius is pressed on a rigid flat with 20 N. Nothing surrounds the contact, so the
boundary is free. Hertz gives the contact radius and the maximum pressure,

.. math:: a^3 = \frac{3 F R}{4 E^*}, \qquad p_0 = \frac{3 F}{2 \pi a^2},

and Huber the stress inside: for :math:`\nu = 0.3` the maximum von Mises stress is :math:`0.620\,p_0`, at
the depth :math:`0.48\,a`.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

radius, force = 10e-3, 20.0  # m, N
steel = asp.Solid(young=210e9, poisson=0.3)  # Pa; without a height it is a half-space

# %%
# The map is 0.3 mm long. A smooth ball is the form of a sphere added to zero roughness.
grid = asp.Grid((128, 128), 0.3e-3)
height = asp.surface.add_sphere(np.zeros(grid.shape), grid, radius)
contact = asp.solve_contact(height, steel, grid.length, force=force, boundary="free")
print(f"maximum pressure {contact.maximum_pressure / 1e9:.3f} GPa")
print(f"maximum violation of the conditions of contact {contact.certificate.worst:.1e}")

# %%
# The stress below the ball, in a section through its axis.
stress = asp.analyse_stress(contact, depths=np.linspace(0, 0.25e-3, 51), quantities=("von_mises",))
contact_radius = np.cbrt(3 * force * radius / (4 * steel.effective_modulus))
maximum_pressure = 3 * force / (2 * np.pi * contact_radius**2)

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.4), layout="compressed")
y, x = grid.coordinates()
middle = grid.shape[0] // 2
r = x - (x[0] + x[-1]) / 2
left.plot(r / contact_radius, contact.pressure[middle] / maximum_pressure, ".", label="computed")
inside = np.linspace(-1, 1, 201)
left.plot(inside, np.sqrt(1 - inside**2), label="Hertz")
left.set(xlabel="x/a", ylabel="p/p₀")
left.legend()
profile = stress["maximum_von_mises"].isel(poisson=0).values
right.plot(stress["plane_depth"] / contact_radius, profile / maximum_pressure)
right.plot(0.481, 0.620, "o", label="Huber: 0.620 p₀ at 0.48 a")
right.set(xlabel="depth/a", ylabel="maximum von Mises stress/p₀")
right.legend()
plt.show()

# %%
# **Check**: pressure, contact area and the maximum von Mises stress with its depth.
deepest = int(profile.argmax())
assert abs(contact.maximum_pressure / maximum_pressure - 1) < 0.002
assert abs(contact.contact_area_fraction * grid.area / (np.pi * contact_radius**2) - 1) < 0.02
assert abs(profile[deepest] / maximum_pressure - 0.620) < 0.002
assert abs(float(stress["plane_depth"][deepest]) / contact_radius - 0.481) < 0.04

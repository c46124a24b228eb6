r"""
Sliding ball: Hamilton and Goodman
==================================

In gross sliding the surface bears the shear traction :math:`\mu p` beside the pressure :math:`p`. Behind the
contact the surface is pulled: Hamilton and Goodman (1966) found the largest tension at the trailing edge,

.. math:: \sigma_{xx} = p_0 \left[ \frac{1 - 2\nu}{3} + \frac{4 + \nu}{8} \pi \mu \right],

and the maximum von Mises stress moves to the surface once :math:`\mu` exceeds about 0.3.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.reference.hertz import Hertz
from asperity.reference.sliding_sphere import SlidingSphere

steel = asp.Solid(young=210e9, poisson=0.3)
friction = 0.5
grid = asp.Grid((128, 128), 0.3e-3)
hertz = Hertz.from_load(20.0, 10e-3, steel.effective_modulus)

# %%
# The pressure is known, so that no contact has to be solved: a ``LoadedSolid`` is a solid under any
# pressure.
y, x = (axis - (axis[0] + axis[-1]) / 2 for axis in grid.coordinates())
pressed = asp.LoadedSolid(hertz.pressure(np.hypot(y[:, None], x)), grid, steel, "free")
a, p0 = hertz.contact_radius, hertz.maximum_pressure

# %%
# Sections through the axis without and with friction. The other body moves to the right.
figure, axes = plt.subplots(2, 1, figsize=(7, 5.5), sharex=True, layout="compressed")
for panel, mu in zip(axes, (0.0, friction), strict=True):
    section = asp.stress_section(pressed, depths=np.linspace(0, 1.6 * a, 40), friction=mu)
    field = section["von_mises"].isel(poisson=0).values / p0
    colours = panel.pcolormesh(x / a, section["depth"] / a, field, vmin=0, vmax=0.95, shading="gouraud")
    panel.set(ylabel="depth/a", title=f"von Mises stress/p₀, μ = {mu}", xlim=(-1.6, 1.6), ylim=(1.6, 0))
figure.colorbar(colours, ax=axes)
axes[-1].set_xlabel("x/a")
plt.show()

# %%
# **Check**: all six components at two depths against the closed form, and the largest tension just below the
# surface. (At the trailing edge itself the stress has an infinite slope, which no grid resolves.)
sliding = SlidingSphere(hertz, friction)
components = ("xx", "yy", "zz", "yz", "xz", "xy")
for plane in asp.stress_planes(
    pressed, [0.2 * a, 0.5 * a], fields=components, friction=friction, tolerance=0
):
    exact = sliding.stress(y[:, None], x, plane.depth, steel.poisson)
    found = np.stack([plane.fields[name][0] for name in components], axis=-1)
    assert np.abs(found - exact).max() < 0.01 * p0
expected = (1 - 2 * steel.poisson) / 3 + (4 + steel.poisson) / 8 * np.pi * friction
print(
    f"largest tension {sliding.stress(0.0, -a, 0.0, steel.poisson)[0] / p0:.3f} p₀, formula {expected:.3f} p₀"
)
(near,) = asp.stress_planes(pressed, [0.05 * a], fields=("xx",), friction=friction)
tension = near.fields["xx"].max()
exact = sliding.stress(y[:, None], x, near.depth, steel.poisson)[..., 0].max()
print(f"0.05 a below the surface {tension / p0:.3f} p₀, closed form {exact / p0:.3f} p₀")
assert abs(tension / exact - 1) < 0.02

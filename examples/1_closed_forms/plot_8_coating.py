r"""
A ball on a coating
===================

A hard coating raises the pressure under a ball and bends over the softer base: its lower face is under
tension. On the interface :math:`\sigma_{xx}` jumps, because both materials have the same strain there. The
shear stress is continuous; it can peel the coating off. A soft coating spreads the load. The reference is an
independent solution of the contact by an integral equation of Fredholm's kind.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.reference.bonded_layer import Coating

radius, contact_radius, thickness, poisson = 10.0, 0.05, 0.04, 0.3
base = asp.Solid(1.0, poisson)
grid = asp.Grid((256, 256), 1.0)
height = asp.surface.add_sphere(np.zeros(grid.shape), grid, radius)

# %%
# Half-spaces under coatings a quarter and four times as stiff, and without one. The load is the one that the
# integral equation gives for the same contact radius.
contacts, expected = {}, {}
for name, ratio in {"soft coating": 0.25, "no coating": 1.0, "hard coating": 4.0}.items():
    solid = asp.Solid(ratio, poisson, thickness, base=base)
    single = Coating(
        thickness, poisson, solid.effective_modulus, base_modulus=base.effective_modulus
    ).paraboloid(contact_radius, radius)
    contacts[name] = asp.solve_contact(height, solid, grid, force=single.load)
    expected[name] = float(single.pressure(0.0))
    print(
        f"{name}: maximum pressure {contacts[name].maximum_pressure / expected[name]:.4f} of the expected one"
    )

# %%
# The stress below the middle. Depths hold both faces of the interface: ``layer.interface`` is the lower face
# of the coating, and the next larger number the upper face of the base.
depths = asp.stress.depth_grid(grid, height=5 * thickness, interface=thickness)
sections = {
    name: asp.stress_section(contact, depths=depths, fields=("xx", "zz", "xz", "von_mises")).isel(poisson=0)
    for name, contact in contacts.items()
}
figure, axes = plt.subplots(1, 2, figsize=(8, 3.8), sharey=True, layout="compressed")
for name, section in sections.items():
    middle = section.sel(x=0.5)
    for axis, field in zip(axes, ("xx", "von_mises"), strict=True):
        axis.plot(middle[field] / contacts[name].maximum_pressure, depths / thickness, label=name)
for axis, label in zip(axes, (r"$\sigma_{xx}/p_0$", r"von Mises stress/$p_0$"), strict=True):
    axis.axhline(1, color="0.6", lw=0.8)
    axis.set(xlabel=label)
axes[0].set(ylabel="depth/thickness", ylim=(5, 0))
axes[1].legend()
plt.show()

# %%
# The whole section under the hard coating.
shown = sections["hard coating"]["xx"] / contacts["hard coating"].maximum_pressure
limit = float(abs(shown).max())
figure, axis = plt.subplots(figsize=(7, 3.2), layout="compressed")
colours = axis.pcolormesh(
    shown["x"], depths, shown, cmap="RdBu_r", vmin=-limit, vmax=limit, shading="nearest", rasterized=True
)
axis.axhline(thickness, color="k", lw=0.8)
axis.set(
    xlabel="x/edge of the map", ylabel="depth/edge", xlim=(0.3, 0.7), ylim=(depths[-1], 0), aspect="equal"
)
figure.colorbar(colours, label=r"$\sigma_{xx}/p_0$")
plt.show()

# %%
# **Check**: the maximum pressure, to the errors of grid and periodic cell; tractions are continuous
# on the interface, and the strain under the middle, where both lateral stresses are equal.
faces = [thickness, np.nextafter(thickness, 1)]
for name, contact in contacts.items():
    np.testing.assert_allclose(contact.maximum_pressure, expected[name], rtol=2e-3)
    above, below = (sections[name].sel(depth=face) for face in faces)
    for field in ("zz", "xz"):
        np.testing.assert_allclose(above[field], below[field], atol=1e-5 * contact.maximum_pressure)
    strain = [
        ((1 - poisson) * face["xx"] - poisson * face["zz"]).sel(x=0.5).item() / young
        for face, young in ((above, contact.layer.young), (below, base.young))
    ]
    np.testing.assert_allclose(*strain, rtol=1e-4)
hard = sections["hard coating"]
assert hard["xx"].sel(depth=faces[0]).max() > 0 > hard["xx"].sel(depth=faces[1], x=0.5)
pressures = [contact.maximum_pressure for contact in contacts.values()]
assert pressures == sorted(pressures)

r"""
Fretting: partial slip of two rough steel bodies
================================================

Two steel bodies are pressed together and then pushed sideways by less than the force at which they slide.
Every contact slips at its edge and sticks inside. ``partial_slip`` finds where, how far the bodies move, and
how much energy is lost if the force swings back and forth.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

length, friction = 200e-6, 0.4
height = asp.self_affine((128, 128), 0.8, 1e-4, 12.5e-6, rms_height=1e-7, seed=1, length=length)
steel = asp.Solid(young=210e9, poisson=0.3)
contact = asp.solve_contact(height, asp.TwoBodies(steel, steel), length, mean_pressure=50e6)
limit = friction * contact.force
slip = asp.contact.partial_slip(contact, friction, tangential_force=0.6 * limit)
print(slip)
print(f"superposition: sticking nodes are displaced unevenly by {100 * slip.deviation:.1f} %")

# %%
# Where the faces stick the slip is zero. The smallest spots slip as a whole.
figure, axes = plt.subplots(1, 2, figsize=(9, 3.8), layout="compressed")
edges = (0, length * 1e6, 0, length * 1e6)
touching, sticking = contact.pressure > 0, slip.sticking.pressure > 0
state = np.ma.masked_equal(touching.astype(int) + sticking, 0)
axes[0].imshow(state, origin="lower", extent=edges, cmap="viridis_r", vmin=1, vmax=2)
axes[0].set(title="slip (yellow) and stick (dark)", xlabel="x (µm)", ylabel="y (µm)")
loop = slip.cycle(12)
force, displacement = loop["tangential_force"].values, loop["tangential_displacement"].values
axes[1].plot(displacement * 1e9, force * 1e3)
axes[1].plot(loop["first_displacement"] * 1e9, loop["first_force"] * 1e3, "--")
axes[1].set(xlabel="tangential displacement (nm)", ylabel="tangential force (mN)")
plt.show()

# %%
# The stress under the shear traction of partial slip lies between the stress without friction and in sliding.
largest = {}
for name, solid, mu in (
    ("no friction", contact.in_body("lower"), 0.0),
    ("partial slip", slip.in_body("lower"), friction),
    ("sliding", contact.in_body("lower"), friction),
):
    stress = asp.analyse_stress(solid, quantities=("von_mises",), friction=mu, tolerance=1e-4)
    largest[name] = float(stress["maximum_von_mises"].max())
    print(f"{name}: maximum von Mises stress {largest[name] / 1e9:.2f} GPa")

# %%
# **Check**: the loop encloses the energy that the slip loses against friction, 4 μ² r ∫ p g* dA; chords of
# the loop leave out a part that falls with the square of their number. The traction carries the force, and
# a ball sticks within (1 − Q/μP)^(1/3) of its contact radius (Cattaneo 1938, Mindlin 1949).
enclosed = abs(np.trapezoid(force, displacement))
assert abs(enclosed / slip.lost_energy - 1) < 0.02
assert abs(slip.traction.mean() * length**2 / (0.6 * limit) - 1) < 1e-5
assert np.all(slip.traction <= friction * contact.pressure)
ball = asp.surface.add_sphere(np.zeros((128, 128)), 1e-3, radius=10e-3)
alone = asp.solve_contact(ball, steel, 1e-3, force=80.0, boundary="free")
sticks = asp.contact.partial_slip(alone, friction, tangential_force=0.6 * friction * alone.force)
assert abs(np.sqrt(sticks.sticking_area) - 0.4 ** (1 / 3)) < 0.01
assert largest["no friction"] < largest["sliding"]

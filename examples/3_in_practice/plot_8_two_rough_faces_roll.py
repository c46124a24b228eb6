r"""
Two rough faces that roll and slide
===================================

Two ground faces with their lay along y move against each other along the lay, or pass through the contact
of a roller with a slide-to-roll ratio of 5 %. ``MovingContact`` solves a contact for every position,
``stress_cycles`` finds the worst history of a point in each row of a body.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

length, nodes = 40e-6, 32
faces = []
for seed, rms in ((1, 6e-8), (2, 3e-8)):
    relief = asp.self_affine((nodes, nodes), 0.8, 20e-6, 5e-6, rms_height=rms, seed=seed, length=length)
    faces.append(0.5 * relief + 0.5 * relief.mean(axis=0))  # a relief, and one elongated along y
ring, honed = faces
steel = asp.Solid(young=210e9, poisson=0.3)
pair = asp.TwoBodies(steel, steel)
# The limits are assumed, the same in all examples: give those of your steel.
limits = {"fatigue_torsion": 500e6, "fatigue_bending": 800e6, "yield_stress": 2e9}
common = {"wavelength_short": 5e-6, "friction": 0.08}

# %%
# Along the lay at a mean pressure of 0.5 GPa: the histories of points of both faces.
along = asp.engineering.MovingContact(
    ring, -honed, pair, length, shifts=24, sliding_direction="y", mean_pressure=0.5e9, **common
)
# %%
# Through a line contact of p₀ = 1 GPa: pressure and phase of the counter-face change with the position.
hertz = asp.stress.HertzContact.from_radii(8e-3, np.inf, pair.effective_modulus, maximum_pressure=1e9)
through = asp.engineering.MovingContact(
    ring, -honed, pair, length, shifts=31, hertz=hertz, slide_to_roll=0.05, **common
)
cycles = {}
for title, moving in {"along the lay": along, "through the contact": through}.items():
    for body in ("lower", "upper"):
        found = asp.stress.stress_cycles(moving.in_body(body), **limits, tolerance=1e-4)
        value, depth, y, x = found.attrs["worst_dang_van"]
        cycles[f"{title}, {body} face"] = found
        print(
            f"{title}, {body} face: {value:.2f} ± {found.attrs['few_shifts_error'] * value:.2f} of the limit "
            f"at depth {depth * 1e6:.2f} µm, x = {x * 1e6:.0f} µm, y = {y * 1e6:.0f} µm"
        )

# %%
# Worst Dang Van stress against the depth.
figure, axes = plt.subplots(figsize=(6, 4), layout="compressed")
for title, found in cycles.items():
    axes.plot(found["dang_van"].max("cycle_y"), found["cycle_depth"] * 1e6, label=title)
axes.set(xlabel="maximum Dang Van stress over limit", ylabel="depth (µm)", ylim=(120, 0.2), yscale="log")
axes.legend()
plt.show()

# %%
# **Check**: far below the roughness the passage is that of the smooth line contact, whose range of σ_xz is
# 0.5 p₀ at half a half-width (Johnson 1985, Sec. 4.2); roughness raises the stress near the surface alone.
found = cycles["through the contact, lower face"]
half = hertz.half_width_x
shear = found["shear_range"].max("cycle_y").interp(cycle_depth=half / 2)
print(f"range of σ_xz at {half * 5e5:.0f} µm: {float(shear) / 1e9:.3f} p₀")
assert abs(float(shear) / 1e9 - 0.5) < 0.02
assert found.attrs["worst_dang_van"][1] < 0.05 * half
smooth = asp.engineering.MovingContact(0 * ring, 0 * ring, pair, length, shifts=31, hertz=hertz, **common)
alone = asp.stress.stress_cycles(smooth.in_body("lower"), **limits, tolerance=1e-4)
assert found.attrs["worst_dang_van"][0] > alone.attrs["worst_dang_van"][0]

r"""
Fatigue under a moving rough surface
====================================

A rough ground surface slides along x over a smooth steel body. Every point of the smooth body sees the row
of stresses along x as its cycle. ``stress_cycles`` compares the worst of them with the fatigue limits by the
criterion of Dang Van, and with the yield stress by bounds of elastic shakedown.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

length = 100e-6
height = asp.self_affine((128, 128), 0.8, 50e-6, 12.5e-6, rms_height=4e-8, seed=3, length=length)
steel = asp.Solid(young=210e9, poisson=0.3)
contact = asp.solve_contact(height, steel, length, mean_pressure=50e6)
# The limits are assumed, the same in all examples: give those of your steel.
limits = {"fatigue_torsion": 500e6, "fatigue_bending": 800e6, "yield_stress": 2e9}
rolling = asp.stress.stress_cycles(contact, **limits)
sliding = asp.stress.stress_cycles(contact, **limits, friction=0.3)

# %%
# The worst rows, without and with friction.
for title, cycles in {"rolling": rolling, "sliding, μ = 0.3": sliding}.items():
    value, depth, y = cycles.attrs["worst_dang_van"]
    low, high = (cycles.attrs[f"worst_shakedown_{bound}"][0] for bound in ("lower", "upper"))
    print(
        f"{title}: {value:.2f} of the fatigue limit at depth {depth * 1e6:.2f} µm, y = {y * 1e6:.1f} µm; "
        f"elastic shakedown up to {low:.2f} to {high:.2f} times the load"
    )

# %%
# Friction brings the worst cycles to the surface.
figure, axes = plt.subplots(2, 1, figsize=(9, 5), sharex=True, layout="compressed")
top = max(float(cycles["dang_van"].max()) for cycles in (rolling, sliding))
for axis, title, cycles in zip(axes, ("rolling", "sliding, μ = 0.3"), (rolling, sliding), strict=True):
    mesh = axis.pcolormesh(
        cycles["cycle_y"] * 1e6,
        cycles["cycle_depth"] * 1e6,
        cycles["dang_van"],
        vmin=0,
        vmax=top,
        cmap="inferno",
        shading="gouraud",
    )
    axis.set(ylim=(10, 0), ylabel="depth (µm)", title=title)
axes[1].set_xlabel("y (µm)")
figure.colorbar(mesh, ax=axes, label="Dang Van stress over fatigue limit")
plt.show()

# %%
# **Check**: under a cylinder, σ_xz changes by half of the maximum pressure, at half of the half-width below
# the surface, and elastic shakedown ends at 4 k, with the yield stress k in shear (Johnson 1985, Sec. 9.3).
cell = (1e-3 / 64, 1e-3)
roller = asp.surface.add_cylinder(np.zeros((16, 1024)), cell, 0.01, axis="y")
line = asp.solve_contact(roller, steel, cell, contact_area_fraction=0.1)
largest, half = line.pressure.max(), 0.05e-3
cycles = asp.stress.stress_cycles(line, half * np.linspace(0.4, 0.6, 11), yield_stress=np.sqrt(3) * 1e9)
shear, depth, _ = cycles.attrs["worst_shear_range"]
assert abs(shear / largest - 0.5) < 2e-3
assert abs(depth / half - 0.5) < 0.03
assert abs(cycles.attrs["worst_shakedown_upper"][0] * largest / 1e9 - 4) < 0.02
assert sliding.attrs["worst_dang_van"][1] < rolling.attrs["worst_dang_van"][1]
assert sliding.attrs["worst_shakedown_lower"][0] < rolling.attrs["worst_shakedown_lower"][0]

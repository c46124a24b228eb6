r"""
Probability that no crack starts
================================

Fatigue limits scatter. With their coefficient of variation and the stressed volume of the specimens on which
they were measured, the cycles of three maps of one ground face give the probability that no crack starts on
an area, with its interval from the maps.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp
from asperity.stress.cycles.stress_cycles import weibull_exponent

edge, scatter, volume = 100e-6, 0.1, 1e-9  # 1 mm³ of stressed volume in a specimen
# The limits are assumed, the same in all examples: give those of your steel.
limits = {"fatigue_torsion": 500e6, "fatigue_bending": 800e6}
steel = asp.Body(young=210e9, poisson=0.3, **limits, residual_stress=-200e6)
asked, answers = {"fatigue_scatter": scatter, "fatigue_volume": volume}, []
for seed in (1, 2, 3):
    height = asp.self_affine((64, 64), 0.8, 50e-6, 12.5e-6, rms_height=4e-8, seed=seed, length=edge)
    surface = asp.HeightMap(height, (edge, edge), periodic=True, unit="m", name=f"ring {seed}")
    answers.append(asp.run(surface, steel, mean_pressure=200e6, cycles=asked))
sample = asp.pool(answers)

# %%
# The probability on areas up to a square centimetre.
for area in (1e-6, 1e-5, 1e-4):
    (row,) = sample.survival(area).itertuples()
    print(f"{area * 1e6:5.0f} mm²: {row.no_crack:.4f}, 95 % between {row.low:.4f} and {row.high:.4f}")

# %%
# The volume above a fraction of the limit, for each map: the result if no scatter is given.
figure, axes = plt.subplots(figsize=(6, 4), layout="compressed")
for answer in answers:
    above = answer.datasets["cycles"]["fatigue_volume"]
    axes.semilogy(above["fatigue_share"], above * 1e6, label=answer.face.name)
axes.set(xlabel="Dang Van stress over limit", xlim=(0, 1.2))
axes.set(ylabel="volume above per area (µm)", ylim=(1e-3, None))
axes.legend()
plt.show()

# %%
# **Check**: under a roller all stresses are proportional to p₀, and so is the half-width: the cracks per area
# rise with the power m + 1 of p₀. Two areas survive together with the product of their probabilities.
flat, cycles = np.zeros((16, 16)), []
for pressure in (1e9, 1.5e9):
    hertz = asp.stress.HertzContact.from_radii(8e-3, np.inf, 115e9, maximum_pressure=pressure)
    passage = asp.engineering.MovingContact(flat, flat, asp.Solid(210e9, 0.3), edge, shifts=41, hertz=hertz)
    depths = hertz.half_width_x * np.linspace(0, 2, 41)
    found = asp.stress.stress_cycles(passage.in_body("lower"), depths, **limits)
    cycles.append(asp.stress.cracks_per_area(found, scatter, volume))
power = np.log(cycles[1] / cycles[0]) / np.log(1.5)
print(f"exponent {power:.3f}, m + 1 = {weibull_exponent(scatter) + 1:.3f}")
assert abs(power / (weibull_exponent(scatter) + 1) - 1) < 2e-3
(small,), (large,) = (sample.survival(area)["no_crack"] for area in (1e-5, 2e-5))
assert abs(small**2 / large - 1) < 1e-12

r"""
Load curve, stiffness and thermal conductance
=============================================

``solve_path`` presses under one load after the other, ``load_curve`` keeps their numbers. The stiffness
:math:`K = d\bar p/d\delta` gives the conductance of the contact spots between two half-spaces (Barber 2003),
here beside two correlations for rough metals.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

edge, conductivity, hardness = 200e-6, 20.0, 2.5e9  # m, W/(m K) of each body, Pa
height = asp.self_affine((256, 256), 0.8, 20e-6, 5e-6, rms_height=0.2e-6, seed=2, length=edge)
steel = asp.Solid(young=200e9, poisson=0.3)
pair = asp.TwoBodies(steel, steel)
loads = np.geomspace(10e6, 300e6, 7)
heat = {"thermal_conductance": 2 / conductivity}
elastic = asp.engineering.load_curve(
    asp.solve_load_path(height, pair, edge, mean_pressures=loads), resistivities=heat
)
plastic = asp.engineering.load_curve(
    asp.solve_load_path(height, pair, edge, mean_pressures=loads, hardness=hardness), resistivities=heat
)
elastic.to_pandas()

# %%
# Mikic (1974) for elastic contacts, 1.55 k m/σ (√2 p/(E* m))^0.94, and Yovanovich (1982) for plastic ones,
# 1.25 k m/σ (p/p_H)^0.95, with the rms height σ, the mean slope m of a profile, for a Gaussian surface
# :math:`m = \bar g/\sqrt{\pi}`, and the harmonic mean k of the conductivities.
roughness = asp.roughness_parameters(height, edge)
slope = roughness.rms_gradient / np.sqrt(np.pi)
factor = conductivity * slope / roughness.rms_height
mikic = 1.55 * factor * (np.sqrt(2) * loads / (pair.effective_modulus * slope)) ** 0.94
yovanovich = 1.25 * factor * (loads / hardness) ** 0.95

# %%
# A hardness enlarges real contact and conductance. Both curves lie within a quarter of their correlation.
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.8), layout="compressed")
for curve, name, style in ((elastic, "elastic", "o-"), (plastic, "hardness 2.5 GPa", "s-")):
    left.loglog(loads / 1e6, curve["contact_area_fraction"], style, label=name)
    right.loglog(loads / 1e6, curve["thermal_conductance"], style, label=name)
right.loglog(loads / 1e6, mikic, "--", label="Mikic, elastic")
right.loglog(loads / 1e6, yovanovich, ":", label="Yovanovich, plastic")
left.set(xlabel="mean pressure (MPa)", ylabel="real contact")
right.set(xlabel="mean pressure (MPa)", ylabel="conductance (W/(m² K))")
left.legend()
right.legend()
plt.show()

# %%
# **Check**: the stiffness is the slope of the load over the approach, and the conductance grows with the load
# in about the power of the correlations.
load = 50e6
contact = asp.solve_contact(height, pair, edge, mean_pressure=load, rtol=1e-10)
low, high = contact.load_interval
step = 0.2 * min(load - low, high - load)
ends = [
    asp.solve_contact(height, pair, edge, mean_pressure=load + sign * step, rtol=1e-10) for sign in (-1, 1)
]
slope_of_load = 2 * step / (ends[1].approach - ends[0].approach)
assert abs(contact.stiffness / slope_of_load - 1) < 1e-4
exponent = np.polyfit(np.log(loads), np.log(elastic["thermal_conductance"]), 1)[0]
ratios = elastic["thermal_conductance"].values / mikic
print(f"conductance ~ load^{exponent:.2f}; over Mikic {ratios.min():.2f} to {ratios.max():.2f}")
assert 0.8 < exponent < 1.1
assert 0.75 < ratios.min() < ratios.max() < 1.25
assert np.all(np.abs(plastic["thermal_conductance"].values / yovanovich - 1) < 0.25)
assert np.all(plastic["contact_area_fraction"].values >= elastic["contact_area_fraction"].values)

r"""
A load path: contact area against load
======================================

The real contact area of a rough surface grows in proportion to the load as long as it is small,

.. math:: \frac{A}{A_0} = \kappa \frac{\bar p}{E^* \bar g},

with :math:`\bar g` the rms gradient and :math:`\kappa` about 2. ``solve_path`` gives one contact after the
other.
"""

import matplotlib.pyplot as plt
import numpy as np

import asperity as asp

solid = asp.Solid(young=1.0, poisson=0.33)
height = asp.self_affine((256, 256), 0.8, 1 / 4, 1 / 32, rms_height=1e-3, seed=2)
gradient = asp.roughness_parameters(height).rms_gradient
scaled = np.array([0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0])
contacts = list(
    asp.solve_load_path(height, solid, mean_pressures=scaled * solid.effective_modulus * gradient)
)
area = np.array([contact.contact_area_fraction for contact in contacts])
kappa = area / scaled

figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="compressed")
left.loglog(scaled, area, "o-")
left.loglog(scaled, 2 * scaled, "--", label="κ = 2")
left.set(xlabel=r"mean pressure/(E* $\bar g$)", ylabel="contact area/nominal area")
left.legend()
right.semilogx(scaled, kappa, "o-")
right.set(xlabel=r"mean pressure/(E* $\bar g$)", ylabel="κ")
plt.show()

# %%
# The gap closes and the mean pressure inside the contacts grows little.
for contact in contacts[::3]:
    inside = contact.mean_contact_pressure / (solid.effective_modulus * contact.gradient_rms_contact)
    print(
        f"area {contact.contact_area_fraction:.3f}, pressure inside {inside:.3f} E*ḡ_r, "
        f"gap {contact.gap.mean():.2e}"
    )

# %%
# **Check**: proportionality with κ about 2 (at the smallest loads contacts are few nodes wide, and their
# area too large), an area that rises to less than the whole, a gap that falls, and the same contact along
# the path and for a single load.
assert np.all(np.diff(area) > 0)
assert area[-1] < 1
assert np.all((kappa[2:6] > 1.9) & (kappa[2:6] < 2.6))
assert np.all(np.diff([contact.gap.mean() for contact in contacts]) < 0)
alone = asp.solve_contact(height, solid, mean_pressure=contacts[4].mean_pressure)
assert np.linalg.norm(alone.pressure - contacts[4].pressure) < 1e-4 * np.linalg.norm(alone.pressure)

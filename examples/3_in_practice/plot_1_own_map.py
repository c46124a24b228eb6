r"""
Your own map: ground steel on aluminium
=======================================

From the height map of an instrument, two materials and a load to an answer in µm and MPa. The command line
does the same with ``asperity run steel.x3p --young "210 GPa" --poisson 0.3 …``.
"""

import matplotlib.pyplot as plt

import asperity as asp

# %%
# In any of the formats that the page *Formats of height maps* lists. This map is part of the repository:
# 40 × 48 pixels of 2 µm, with spikes and non-measured points. Put the name of your own file in its place.
surface = asp.read_map("../../tests/data/steel.x3p")
size = " × ".join(f"{edge * 1e6:g}" for edge in surface.length)
print(f"{surface.name}: {size} µm, {surface.missing} non-measured points, period: {surface.periodic}")

# %%
# The bodies, the load, and what is done to the map: spikes are removed, waves shorter than eight pixels are
# filtered, and the cell is refined so that the contacts are resolved.
steel = asp.Body(young=210e9, poisson=0.3, yield_stress=1.5e9)
aluminium = asp.Body(young=70e9, poisson=0.33, yield_stress=300e6)
treated = {"file": surface, "despike": 8, "wavelength_short": "16 um", "points": 96}
answer = asp.run(treated, steel, aluminium, mean_pressure=20e6)
print(answer)

# %%
figure, axes = plt.subplots(1, 2, figsize=(10, 4.6), layout="compressed")
asp.views.plot_height(answer.contact, axes=axes[0], unit_system="SI")
asp.views.plot_pressure(answer.contact, axes=axes[1], unit_system="SI")
plt.show()

# %%
# **Check**: the load is the one asked for, both bodies carry the pressure of one contact, and the area that
# is extrapolated to zero pixel size is near the area on the pixels.
assert abs(answer["mean pressure"].value / 20e6 - 1) < 1e-6
assert answer.contact.certificate.worst < 1e-4
lower, upper = (answer.record("maximum von Mises stress", body).value for body in ("lower", "upper"))
assert abs(lower / upper - 1) < 0.1
assert all(0.3 < value / answer["maximum pressure"].value < 0.9 for value in (lower, upper))
area = answer["contact area fraction"]
assert 0.8 < area.extrapolated / area.value < 1

"""Settings and results of a study small enough to run in a test."""

from asperity.study.stages.contact import press_surface
from asperity.study.stages.statistics import SeedResults
from asperity.study.stages.stress import compute_stress
from asperity.study.stages.surface import make_surface

SURFACE = {
    "label": "small",
    "hurst": 0.8,
    "wavelength_long": 0.25,
    "wavelength_short": 0.125,
    "rms_height": 1e-3,
    "points": 64,
}

LAYER = {
    "height": 1.0,
    "bottom": "bonded",
    "poisson": 0.33,
    "lateral": "confined",
    "half_space_tolerance": 0.03,
}
CONTACT = {
    "method": "active_set",
    "contact_area_fraction": 0.1,
    "path_contact_area_fractions": [0.05, 0.08, 0.1, 0.15],
    "tolerance": 1e-6,
    "precision": "float64",
}
STRESS = {"poisson": [0.0, 0.33], "tolerance": 1e-4, "depth_spacing": 0.5}
SETTINGS = {"name": "small", "seed": 1, "surface": SURFACE, "layer": LAYER, "contact": CONTACT}
"""Settings of the contact of a seed."""


def results_of(seed, layer=LAYER, surface=SURFACE):
    """Surface, contact and stress of a seed."""
    made = make_surface(surface, seed)
    contact = press_surface(made, layer, CONTACT)
    return SeedResults(seed, made, contact, compute_stress(contact, layer, STRESS)[layer["lateral"]])

"""Settings of a study small enough to run in a test."""

LAYER = {
    "height": 1.0,
    "bottom": "bonded",
    "poisson": 0.33,
    "lateral": "confined",
    "half_space_tolerance": 0.03,
}
CONTACT = {
    "method": "active_set",
    "area_fraction": 0.1,
    "path_area_fractions": [0.05, 0.08, 0.1, 0.15],
    "tolerance": 1e-6,
    "precision": "float64",
}
STRESS = {"poisson": [0.0, 0.33], "tolerance": 1e-4, "depth_spacing": 0.5}

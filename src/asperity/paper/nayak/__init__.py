"""True contact area against Nayak's parameter of the surface: samples, continuum limits, regression, page."""

"""Numbers of claims to a given error by the multilevel Monte Carlo method."""

"""The fast solver: an active-set method on nested grids."""

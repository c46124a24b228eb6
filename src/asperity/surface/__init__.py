"""Rough surfaces: random ones, measured ones, and their roughness parameters."""

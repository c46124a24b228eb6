"""Stress inside the solid: planes over depth, peaks, profiles, statistics."""

"""Comparison of the library with closed forms, finite elements and exact arithmetic."""

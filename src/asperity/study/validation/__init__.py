"""Comparisons of the library with closed forms, finite elements, high precision and direct solutions."""

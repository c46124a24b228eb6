"""Histories of the stress at points of a body under a moving contact: range, fatigue and shakedown."""

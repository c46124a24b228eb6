"""Rough surfaces: random, with prescribed moments, and measured."""

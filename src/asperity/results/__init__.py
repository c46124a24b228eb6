"""Result files: NetCDF datasets with names, units, descriptions and fingerprints."""

from asperity.results.dataset import read as read_result

__all__ = ["read_result"]

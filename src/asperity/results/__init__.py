"""Result files: NetCDF datasets with names, units, descriptions and fingerprints."""

from asperity.results.dataset import read as read_result
from asperity.results.dataset import write as write_result

__all__ = ["read_result", "write_result"]

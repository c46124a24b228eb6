"""Result files: NetCDF datasets with names, units, descriptions and fingerprints."""

from importlib.util import find_spec

# A study can be planned with Snakemake alone: without lazy_loader the public names are missing.
if find_spec("lazy_loader"):
    import lazy_loader

    __getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""Result files: NetCDF datasets with names, units and fingerprints."""

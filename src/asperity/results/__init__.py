"""Result files: NetCDF datasets with names, units, descriptions and fingerprints."""

"""The settings of asperity: their description, defaults and presets, and the check of a configuration.

`schema.yaml` is the one place for type, range, unit, default and description of a setting; `schema` reads it.
"""

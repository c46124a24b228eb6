"""Everything that a user sets, each setting once: groups of a case, configuration of a study, materials.

A setting is a field of a class with its type, range, unit, default and text. Reading YAML, the check, the
JSON Schema, the flags of the command line and their help, the tables of the documentation and the forms of a
page are made from these classes. This room computes nothing.
"""

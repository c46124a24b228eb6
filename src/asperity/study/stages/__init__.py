"""The stages of the study, one module each: datasets in, dataset out, in the order of the method section.

surface → contact → stress → statistics → figures. A stage composes the library and writes nothing.
"""

"""From a measured map, two materials and a load to the answer of an engineer, in SI units.

`run` carries out all stages and returns an `Answer`: real contact, pressures, largest stress with its depth
and position, volume above yield, warnings and notes. `write_answer` writes result files, pictures, tables and
a report page into a folder. The public names are listed in ``__init__.pyi`` and imported when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

"""From a measured map, two materials and a load to the answer of an engineer, in SI units.

`run` carries out all stages and returns an `Answer`: contact area, pressures, maximum stresses with their
positions, volume above yield, warnings and notes. `Answer.write` writes result files, tables, pictures and a
report page into a folder, and `open_answer` opens it again. The public names are listed in ``__init__.pyi``
and imported when first used.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

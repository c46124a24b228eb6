"""Pictures of results, of one surface or of several beside each other, and the style of all figures.

`maps` draws height, pressure and gap over the cell, `stress_plot` the stress in a vertical section or
in a plane at a depth, `peak_plot` the stress peaks over depth. `source` reads results for them,
`scales` chooses units and the range of the colours. `export` writes tables and VTK images.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

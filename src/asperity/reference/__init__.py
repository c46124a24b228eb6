"""Closed forms and independent numerical solutions that the library is compared with.

Nothing here uses the kernels, layers or solvers of the library; only `asperity.core` is imported.

| module | solution |
|---|---|
| `hertz` | sphere on a half-space: surface, axis and interior; cylinder, at rest or sliding |
| `elliptic_hertz` | ellipse of contact on a half-space: pressure, and stress on the axis |
| `sliding_sphere` | sphere that slides on a half-space: stress everywhere |
| `periodic_hertz` | square array of spheres on a half-space, the paper's Eqs. 11–16 as corrected |
| `westergaard` | one-dimensional wave on a half-space: surface and interior |
| `bisinusoid` | bisinusoidal wave on a half-space: asymptotes of small and nearly complete contact |
| `bonded_layer` | flat punch and paraboloid on a bonded layer, by a Fredholm equation |
| `state_space` | one Fourier mode of a layer, to any number of digits |
| `pivoting` | contact on a small periodic grid by principal pivoting, without iterating on pressures |
| `finite_element` | paraboloid on a bonded slab by 27-node hexahedra |

Conventions: z up, ``depth ≥ 0`` downward from the surface, tension positive, contact pressure and approach
positive. Displacement vectors are (x, y, z) with z up; the displacement of a surface under pressure, a
scalar, is positive downward. Stress components are in the order xx, yy, zz, yz, xz, xy along the last axis.
Lengths and stresses are in any consistent units: stresses come in the unit of the modulus that is given.
"""

from pkgutil import iter_modules

import lazy_loader

_names = {module.name for module in iter_modules(__path__)}
__getattr__, __dir__, __all__ = lazy_loader.attach(__name__, _names)

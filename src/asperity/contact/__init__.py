"""Contact of an elastic solid with a rough surface: without friction, up to a hardness, and with adhesion.

The indenter's height ``h[y, x]`` is its lower face measured upward, so the lowest points touch first. Under a
pressure p ≥ 0 the surface of the solid moves down by u, and the gap is ``g = h + u − δ ≥ 0`` with the
approach δ of the indenter. Where the solid has no uniform displacement (half-space, free bottom, confined and
incompressible) u has mean zero, and δ is measured from the mean plane of the solid's surface.

With a hardness p_H, p ≤ p_H, and g ≤ 0 where p = p_H: the surface is flattened there by −g.

With an `Adhesion` the pressure has tensile parts; see `adhesion`.

`solve_contact` scales the problem (`problem`), a method finds p (`active_set`, `gfmd`), and `certificate`
checks it
independently. `load` computes the change of p with the load: stiffness, the loads between which the same
nodes touch, and control by area. The loop of the fast method is written at the top of `active_set`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

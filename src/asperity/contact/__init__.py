"""Contact of an elastic solid with a rigid rough surface: frictionless, without adhesion, a hard wall.

The indenter's height ``h[y, x]`` is its lower face measured upward, so the lowest points touch first. Under a
pressure p ≥ 0 the surface of the solid moves down by u, and the gap is ``g = h + u − δ ≥ 0`` with the
approach δ of the indenter. Where the solid has no uniform displacement (half-space, free bottom, confined and
incompressible) u has mean zero, and δ is measured from the mean plane of the solid's surface.

The fast method in twelve lines, each with the module that holds it:

    units of edge, modulus and heights                                   units
    p = start from the coarser grids                                     active_set/nested_grids
    repeat on each grid, first in single precision:                      active_set/outer_loop
        u = G p, gap of the contact nodes                                active_set/iterate
        r = δ − (h + u); error = |M r| and penetrations over |p|         active_set/assembly
        stop if the error is below the tolerance                         active_set/outer_loop
        solve G x = r on the contact nodes by conjugate gradients        active_set/inner_solve
            with G from a stencil and a coarser grid                     compliance/inner_response, stencil
            with M ≈ 1/G from a stencil and a coarse grid                compliance/preconditioner
        add a change of the load if an area is imposed                   active_set/area
        p = p + x; nodes enter and leave; the energy does not grow       active_set/step
    certify p from the heights and the solid                             certificate
"""

from asperity.contact.certificate import Certificate, verify_contact
from asperity.contact.solution import Contact
from asperity.contact.solve import METHODS, solve, solve_path
from asperity.core.errors import ConvergenceError

__all__ = ["METHODS", "Certificate", "Contact", "ConvergenceError", "solve", "solve_path", "verify_contact"]

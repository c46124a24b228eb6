"""Contact of an elastic solid with a rigid rough surface: frictionless, without adhesion, a hard wall.

The indenter's height ``h[y, x]`` is its lower face measured upward, so the lowest points touch first. Under a
pressure p ≥ 0 the surface of the solid moves down by u, and the gap is ``g = h + u − δ ≥ 0`` with the
approach δ of the indenter. Where the solid has no uniform displacement (half-space, free bottom, confined and
incompressible) u has mean zero, and δ is measured from the mean plane of the solid's surface.
"""

from asperity.contact.certificate import Certificate, verify_contact
from asperity.contact.load_path import solve_path
from asperity.contact.solution import Contact
from asperity.contact.solver import METHODS, solve
from asperity.errors import ConvergenceError

__all__ = ["METHODS", "Certificate", "Contact", "ConvergenceError", "solve", "solve_path", "verify_contact"]

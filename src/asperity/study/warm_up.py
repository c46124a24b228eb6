"""Compilation before the jobs of a study: ``python -m asperity.study.warm_up``.

Numba compiles a function at its first call and keeps the machine code beside the module, where others
find it: afterwards the jobs do not compile the same functions side by side.
"""

from __future__ import annotations

from asperity.contact import solve
from asperity.elasticity.layer import Layer
from asperity.stress.analysis import analyse_stress
from asperity.surface.self_affine import self_affine


def warm_up() -> None:
    """Solve a small contact and analyse the stress below it, in single and in double precision."""
    height = self_affine((64, 64), 0.8, 0.5, 0.125, 1e-3, seed=1)
    for precision, tolerance in (("float32", 1e-2), ("float64", 1e-6)):
        contact = solve(height, Layer(1.0, 0.33), area_fraction=0.1, rtol=1e-4, dtype=precision)
        analyse_stress(contact, tolerance=tolerance)


if __name__ == "__main__":
    warm_up()

"""One mode of a stack of layers to many digits, from equilibrium and Hooke's law in every layer at once."""

from itertools import pairwise

import mpmath as mp
import numpy as np

from asperity.reference.state_space import _HELD, StateSpace

DIGITS = 110
"""A layer with q height = 1e-6 takes 24 of them, and the ratio of two moduli as many as it has."""


class LayeredMode:
    """Amplitudes of all layers and of an elastic base, from the conditions on top and on every interface."""

    def __init__(self, qx, qy, solid, top=(0, 0, -1)):
        parts, self.depths = solid.parts, [0.0, *solid.interfaces]
        self.modes = [
            StateSpace(qx, qy, part.young, part.poisson, part.height, part.bottom, digits=DIGITS)
            for part in parts
        ]
        with mp.workdps(DIGITS):
            sizes = [3 if part.height is None else 6 for part in parts]
            firsts = np.cumsum([0, *sizes])
            rows = np.full((firsts[-1], firsts[-1]), mp.mpf(0), object)
            rows[:3, : sizes[0]] = self.modes[0]._states(0)[3:]
            for number, mode in enumerate(self.modes):
                own, at = slice(firsts[number], firsts[number + 1]), 3 + 6 * number
                if number < len(parts) - 1:
                    following = slice(firsts[number + 1], firsts[number + 2])
                    rows[at : at + 6, own] = mode._states(mode.height)
                    rows[at : at + 6, following] = -self.modes[number + 1]._states(0)
                elif mode.height is not None:
                    rows[at : at + 3, own] = mode._states(mode.height)[_HELD[mode.bottom]]
            # Displacements and stresses differ by the modulus, which pivots have to see.
            values = mp.matrix([*top, *[0] * (len(rows) - 3)])
            found = np.array(list(mp.lu_solve(mp.matrix(rows.tolist()), values)), object)
            self.amplitudes = [found[a:b] for a, b in pairwise(firsts)]

    def at(self, depth):
        """Stress and displacement; a depth equal to an interface belongs to the layer above it."""
        place = int(np.searchsorted(self.depths[1:], depth))
        mode, amplitudes = self.modes[place], self.amplitudes[place]
        below = mp.mpf(depth) - mp.mpf(self.depths[place])
        if mode.height is not None:
            below = min(below, mode.height)
        return mode.stress(below, amplitudes), mode.state(below, amplitudes)[:3]

"""Percolation and constrictions of the gap, against known thresholds, duality, and a spanning tree."""

import numpy as np
import pytest
from samples import HALF_SPACE, rough, with_gap
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree

import asperity as asp
from asperity.contact.gap import open_gap, spanned


def test_white_noise_percolates_at_the_known_threshold():
    """Sites of a square lattice: 0.592746 (M. E. J. Newman, R. M. Ziff, Phys. Rev. Lett. 85 (2000) 4104).

    The share of open sites at which the noise opens scatters about it by about n^(−3/4), 0.02 for n = 192.
    """
    found = []
    for seed in range(6):
        noise = np.random.default_rng(seed).random((192, 192))
        for boundary in ("periodic", "free"):
            constriction = asp.contact.percolation(with_gap(noise, boundary)).constriction
            found += [np.mean(noise >= width) for width in constriction]
    assert np.mean(found) == pytest.approx(0.592746, abs=0.006)


def test_contact_or_gap_percolates():
    """Contact spans a map along y, by edges and corners, or the gap along x, by edges: one and not both."""
    for seed in range(20):
        phase = np.random.default_rng(seed).random((24, 31)) < 0.41
        contact, gap = spanned(phase, False, diagonals=True), spanned(~phase, False, diagonals=False)
        assert contact == (not gap[1], not gap[0])
    diagonal = np.eye(8, dtype=bool)
    assert spanned(diagonal, True, diagonals=True) == (True, True)
    assert spanned(diagonal, True, diagonals=False) == (False, False)
    assert spanned(np.roll(diagonal, 3, axis=0), False, diagonals=True) == (False, False)


def test_constriction_is_that_of_a_spanning_tree():
    """The bottleneck of the best path between two edges, from a tree of largest gaps (scipy)."""
    gap = open_gap(asp.solve_contact(rough((48, 40)), HALF_SPACE, mean_pressure=2e-3, boundary="free"))
    found = asp.contact.percolation(with_gap(gap, "free"))
    number = np.arange(gap.size).reshape(gap.shape)
    pairs = [(number[1:], number[:-1]), (number[:, 1:], number[:, :-1])]
    one, other = (np.concatenate([pair[end].ravel() for pair in pairs]) for end in (0, 1))
    width = np.minimum(gap.ravel()[one], gap.ravel()[other])
    for axis, ends in enumerate([(number[0], number[-1]), (number[:, 0], number[:, -1])]):
        first, last = (np.full(end.size, gap.size + side) for side, end in enumerate(ends))
        rows, columns = np.concatenate([one, *ends]), np.concatenate([other, first, last])
        weight = np.concatenate([width, *(gap.ravel()[end] for end in ends)])
        kept = weight > 0
        shape = (gap.size + 2, gap.size + 2)
        tree = minimum_spanning_tree(coo_array((-weight[kept], (rows[kept], columns[kept])), shape)).tocoo()
        widths = np.unique(-tree.data)
        joined = [
            connected_components(coo_array((tree.data[wide], (tree.row[wide], tree.col[wide])), shape))[1]
            for wide in (-tree.data >= each for each in widths)
        ]
        last = max(n for n, label in enumerate(joined) if label[-1] == label[-2])
        assert found.constriction[axis] == pytest.approx(widths[last], rel=1e-12)
        row, column = np.round(np.array(found.place[axis]) * gap.shape).astype(int)
        assert gap[row, column] == found.constriction[axis]


def test_closed_gap_has_no_path():
    gap = np.ones((8, 12))
    gap[:, 5] = 0.0
    found = asp.contact.percolation(with_gap(gap))
    assert (found.gap, found.contact) == ((True, False), (True, False))
    assert found.constriction == (1.0, 0.0)
    assert np.isnan(found.place[1]).all()

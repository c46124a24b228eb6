"""Percolation, constrictions and flow of the gap, against closed forms, duality, and another solver."""

from dataclasses import replace

import numpy as np
import pytest
from samples import HALF_SPACE, refuses, rough
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components, minimum_spanning_tree

import asperity as asp
from asperity.contact.gap import open_gap, spanned
from asperity.core.packages import MissingPackageError, absent

flows = pytest.mark.skipif(bool(absent(["reynoldsflow"])), reason='pip install "asperity[flow]"')
CONTACT = asp.solve_contact(rough((32, 32)), HALF_SPACE, mean_pressure=1e-3)


def with_gap(gap, boundary="periodic", length=1.0):
    """A contact with a gap that is given, closed where it is 0."""
    grid = asp.Grid(gap.shape, length)
    pressure = np.where(gap > 0, 0.0, 1.0)
    return replace(CONTACT, gap=gap, pressure=pressure, grid=grid, boundary=boundary)


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


WAVE = 1.0 + 0.6 * np.cos(2 * np.pi * np.arange(64) / 64)


@flows
@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("direction", ["x", "y"])
def test_flow_through_waves(direction, boundary):
    """Across the flow the mean of g³, along it 1/(mean of 1/g³); solver, and half a spacing at open ends."""
    along, across = np.broadcast_to(WAVE, (64, 64)), np.broadcast_to(WAVE[:, None], (64, 64))
    if direction == "y":
        along, across = across, along
    for gap, expected in ((across, np.mean(WAVE**3)), (along, 1 / np.mean(WAVE**-3.0))):
        flow = asp.contact.film_flow(with_gap(2e-6 * gap, boundary, 1e-3), 0.1, 1e5, direction)
        rate = (2e-6) ** 3 * expected * 1e5 / (12 * 0.1)  # times width over length
        assert flow.flow_rate == pytest.approx(rate, rel=1e-6)
        assert flow.flow_factor == pytest.approx(expected, rel=1e-6)
        axis = "yx".index(direction)
        assert flow.flux[axis].mean() * 1e-3 == pytest.approx(rate, rel=1e-6)
        np.testing.assert_allclose(flow.flux[1 - axis], 0, atol=1e-6 * rate / 1e-3)
        mean_fall = np.ptp(flow.pressure.mean(axis=1 - axis))
        assert mean_fall == pytest.approx(1e5 * 63 / 64, rel=0.1)


@flows
@pytest.mark.parametrize("columns", [32, 24])
def test_channel_and_oblong_maps(columns):
    """A straight channel in a closed map carries w g³ Δp / (12 η L); twice as long, half of it."""
    gap, length = np.zeros((16, columns)), (1.0, columns / 16)
    gap[4:10] = 3.0
    flow = asp.contact.film_flow(with_gap(gap, length=length), 1.0, 1.0, "x")
    assert flow.flow_rate == pytest.approx(6 / 16 * 27 / 12 / length[1], rel=1e-6)
    assert np.isnan(flow.pressure[gap == 0]).all()
    np.testing.assert_allclose(np.diff(flow.pressure[5]), -1 / columns, rtol=1e-6)
    with pytest.raises(ValueError, match="flow_direction = 'y': x, along which it is open"):
        asp.contact.film_flow(with_gap(gap, length=length), 1.0, 1.0, "y")
    with pytest.raises(ValueError, match=r"map: 61 × 97 nodes.* common multiple of at most 4096"):
        asp.contact.film_flow(with_gap(np.ones((61, 97)), length=(61.0, 97.0)), 1.0, 1.0, "x")


@flows
def test_rough_gap_conserves_the_film():
    """Sections carry the same flow, and the flow factor lies between the bounds of Wiener and Voigt."""
    contact = asp.solve_contact(rough((48, 48)), HALF_SPACE, mean_pressure=1e-3)
    flow = asp.contact.film_flow(contact, 1e-6, 1e-3, "y")
    assert flow.conservation_error < 1e-6
    gap = open_gap(contact)
    rows = (gap**3).mean(axis=1)
    assert 0 < flow.flow_factor < 1 / np.mean(1 / rows) / gap.mean() ** 3
    mirrored = with_gap(np.pad(gap, [(0, 48), (0, 48)], "symmetric"), length=2.0)
    sealed = asp.contact.film_flow(with_gap(gap, "free"), 1e-6, 1e-3, "y")
    whole = asp.contact.film_flow(mirrored, 1e-6, 2e-3, "y")
    assert whole.flow_rate == pytest.approx(2 * sealed.flow_rate, rel=1e-6)
    np.testing.assert_allclose(whole.pressure[:48, :48] - 1e-3, sealed.pressure, atol=1e-8)


def test_missing_package_is_named(monkeypatch):
    monkeypatch.setattr("asperity.core.packages.find_spec", lambda module: None)
    with pytest.raises(
        MissingPackageError, match=r'reynoldsflow; install with: pip install "asperity\[flow\]"'
    ):
        asp.contact.film_flow(CONTACT, 1.0, 1.0)


ODD = with_gap(np.ones((10, 16)))
test_bad_arguments = pytest.mark.skipif(bool(absent(["reynoldsflow"])), reason="reynoldsflow")(
    refuses(
        (lambda: asp.contact.film_flow(CONTACT, 0.0, 1.0), "viscosity = 0"),
        (lambda: asp.contact.film_flow(CONTACT, 1.0, -1.0), "pressure_difference = -1"),
        (lambda: asp.contact.film_flow(CONTACT, 1.0, 1.0, "z"), "flow_direction = 'z'"),
        (lambda: asp.contact.film_flow(ODD, 1.0, 1.0), "map: 10 × 16 nodes"),
    )
)

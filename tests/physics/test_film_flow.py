"""Flow of a thin film through the gap, against closed forms, direct solutions, and symmetry."""

import numpy as np
import pytest
from samples import HALF_SPACE, refuses, rough, with_gap

import asperity as asp
from asperity.contact.gap import open_gap
from asperity.core.packages import MissingPackageError, absent

flows = pytest.mark.skipif(bool(absent(["pyamg"])), reason='pip install "asperity[flow]"')
CONTACT = asp.solve_contact(rough((32, 32)), HALF_SPACE, mean_pressure=1e-3)


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
    sealed = asp.contact.film_flow(with_gap(gap, length=length), 1.0, 1.0, "y")
    assert (sealed.flow_rate, sealed.flow_factor, sealed.conservation_error) == (0, 0, 0)
    assert not sealed.flux.any()


@flows
@pytest.mark.parametrize("boundary", ["periodic", "free"])
def test_channels_in_parallel_and_in_series(boundary):
    """Pixels of 1 × 3, 8 × 256 nodes: conductances w g³ / L add in parallel, their inverses in series."""
    gap = np.zeros((8, 256))
    gap[1], gap[3:5, :64], gap[3:5, 64:], gap[6, 10:40] = 2.0, 1.0, 3.0, 5.0  # the last is a closed pore
    flow = asp.contact.film_flow(with_gap(gap, boundary, (8.0, 768.0)), 1 / 12, 1.0, "x")
    faces = [np.concatenate([[1.0] * 64, [27.0] * 192])]
    series = 2 / (3 * (1 / faces[0]).sum())
    assert flow.flow_rate == pytest.approx(8 / 768 + series, rel=1e-9)
    assert np.isnan(flow.pressure[6]).all()


def direct_solution(gap, lengths, boundary):
    """Flow along x by dense equations: from the definition, cell by cell."""
    (rows, columns), number = gap.shape, np.arange(gap.size).reshape(gap.shape)
    ratio = lengths[0] / rows / (lengths[1] / columns)
    matrix, inflow, faces = np.zeros((gap.size, gap.size)), np.zeros(gap.size), []
    for y, x in np.ndindex(gap.shape):
        for down, right in ((1, 0), (0, 1)):
            other = (y + down) % rows, (x + right) % columns
            crosses = (y + down, x + right) != other
            if crosses and boundary == "free":
                continue
            if gap[y, x] * gap[other] > 0:
                conductance = 2 / (gap[y, x] ** -3 + gap[other] ** -3) * (1 / ratio if down else ratio)
                one, two, jump = number[y, x], number[other], float(crosses and right)
                matrix[[one, two], [one, two]] += conductance
                matrix[[one, two], [two, one]] -= conductance
                inflow[[one, two]] += np.array([-jump, jump]) * conductance
                faces.append((one, two, conductance, jump))
    for y in range(rows if boundary == "free" else 0):
        for x, pressure in ((0, 1.0), (columns - 1, 0.0)):
            matrix[number[y, x], number[y, x]] += 2 * gap[y, x] ** 3 * ratio
            inflow[number[y, x]] += 2 * gap[y, x] ** 3 * ratio * pressure
    scale = 1 / np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))
    pressure = scale * np.linalg.lstsq(scale[:, None] * matrix * scale, scale * inflow, rcond=1e-13)[0]
    if boundary == "free":
        ends = 2 * gap[:, 0] ** 3 * ratio * (1 - pressure[number[:, 0]])
        return ends.sum(), pressure.reshape(gap.shape)
    power = sum(k * (pressure[one] - pressure[two] + jump) ** 2 for one, two, k, jump in faces)
    return power, pressure.reshape(gap.shape)


@flows
@pytest.mark.parametrize("boundary", ["periodic", "free"])
@pytest.mark.parametrize("shape", [(12, 16), (16, 12), (3, 33), (4, 64)])
def test_flow_is_that_of_dense_equations(shape, boundary):
    """Random gaps whose g³ spans 9 to 18 decades, on pixels that are not square, in both directions."""
    opened, lengths = 0, (1.0, 2.3)
    for seed in range(6):
        random = np.random.default_rng(seed)
        gap = random.random(shape) ** (1 + seed % 2)
        gap[random.random(shape) < 0.15] = 0.0
        for direction, turned, edges in (("x", gap, lengths), ("y", gap.T, lengths[::-1])):
            flow = asp.contact.film_flow(with_gap(gap, boundary, lengths), 1 / 12, 1.0, direction)
            rate, pressure = direct_solution(turned, edges, boundary)
            assert flow.flow_rate == pytest.approx(rate, rel=1e-8, abs=1e-12)
            opened += flow.flow_rate > 0
            if boundary == "free" and flow.flow_rate > 0:
                found = flow.pressure if direction == "x" else flow.pressure.T
                known = ~np.isnan(found) & (turned > 0.2)  # the dense solution rounds narrower pores off
                np.testing.assert_allclose(found[known], pressure[known], atol=1e-5)
    assert opened >= 6


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
    with pytest.raises(MissingPackageError, match=r'pyamg; install with: pip install "asperity\[flow\]"'):
        asp.contact.film_flow(CONTACT, 1.0, 1.0)


test_bad_arguments = pytest.mark.skipif(bool(absent(["pyamg"])), reason="pyamg")(
    refuses(
        (lambda: asp.contact.film_flow(CONTACT, 0.0, 1.0), "viscosity = 0"),
        (lambda: asp.contact.film_flow(CONTACT, 1.0, -1.0), "pressure_difference = -1"),
        (lambda: asp.contact.film_flow(CONTACT, 1.0, 1.0, "z"), "flow_direction = 'z'"),
    )
)

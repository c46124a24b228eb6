"""Equations of the paper as printed and as corrected, against the independent high-precision solution.

For every correction the printed form differs from the independent solution by far more than rounding, and
the corrected form agrees with it to all digits.
"""

import mpmath as mp
import numpy as np
import printed
import pytest

from asperity.elasticity.solid import Solid
from asperity.reference.state_space import StateSpace

# Rounding of 60-digit arithmetic, with the digits lost in the solves.
EXACT = mp.mpf(10) ** -40
WRONG = 0.01


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(60):
        yield


@pytest.fixture(params=[(0.7, -1.1, 0.9, 2.3, 0.31), (2.0, 1.3, 0.4, 1.0, -0.4)])
def mode(request):
    """Wavevector, height, Young's modulus and Poisson's ratio."""
    return [mp.mpf(value) for value in request.param]


@pytest.fixture
def profile(mode):
    """Displacement in a bonded layer by the independent solution, with two derivatives along z."""
    qx, qy, height, young, nu = mode
    solid = StateSpace(qx, qy, young, nu, height, digits=60)
    state = solid.state(0.3 * height)
    slope = solid.system @ state
    return np.array([state, slope, solid.system @ slope])[:, :3]


@pytest.fixture
def faces(mode):
    """Compliance of both faces by the independent solution, and the size of each of its entries."""
    qx, qy, height, young, nu = mode
    true = StateSpace(qx, qy, young, nu, height, "free", digits=60).compliance()
    size = np.array([mp.sqrt(abs(entry)) for entry in np.diag(true)])
    return true, np.outer(size, size)


def scale(values):
    return max(abs(value) for value in np.ravel(values))


def ratio(nu):
    return (1 - 2 * nu) / (2 * (1 - nu))


def test_equation_3(mode, profile):
    """Printed are ∂x² + ∂y² for ∂y² + ∂z² in the first line, and ∂x² + ∂z² for ∂x² + ∂y² in the third."""
    qx, qy, _, young, nu = mode
    c11, c12, c44 = printed.elastic_constants(young, nu)
    (ux, uy, uz), (ux1, uy1, uz1), (ux2, uy2, uz2) = profile
    x, y, mixed = 1j * qx, 1j * qy, c12 + c44
    size = young * (qx**2 + qy**2) * scale(profile[0])
    first = c11 * x * x * ux + mixed * (x * y * uy + x * uz1)
    third = c11 * uz2 + mixed * (y * uy1 + x * ux1)
    second = c44 * (x * x * uy + uy2) + c11 * y * y * uy + mixed * (x * y * ux + y * uz1)
    right = [c44 * (y * y * ux + ux2) + first, second, c44 * (x * x * uz + y * y * uz) + third]
    assert scale(right) < EXACT * size
    assert abs(c44 * (x * x * ux + y * y * ux) + first) > WRONG * size
    assert abs(c44 * (x * x * uz + uz2) + third) > WRONG * size


def equation_4(displacement, qx, qy, s):
    """Left-hand sides from (u_x, u_y, u_z) and its first and second derivative along z."""
    (ux, uy, uz), (ux1, uy1, uz1), (ux2, uy2, uz2) = displacement
    x, y = 1j * qx, 1j * qy
    sides = [
        s * (y * y * ux + x * y * uy + x * uz1 + ux2) + (1 - 2 * s) * (x * y * uy + x * uz1) + x * x * ux,
        s * (x * x * uy + x * y * ux + y * uz1 + uy2) + (1 - 2 * s) * (x * y * ux + y * uz1) + y * y * uy,
        s * (x * x * uz + y * y * uz + x * ux1 + y * uy1) + uz2 + (1 - 2 * s) * (x * ux1 + y * uy1),
    ]
    return np.array(sides)


def test_equation_4_holds(mode, profile):
    qx, qy, _, _, nu = mode
    assert scale(equation_4(profile, qx, qy, ratio(nu))) < EXACT * (qx**2 + qy**2) * scale(profile[0])


def test_equation_6_solves_equation_4_without_f34(mode):
    qx, qy, _, _, nu = mode
    z, step = mp.mpf("0.37"), mp.mpf(10) ** -20

    def basis(at, corrected):
        return np.array(printed.basis(mp, qx, qy, at, ratio(nu), corrected))

    for corrected, wrong in ((True, []), (False, [3])):
        values, slopes = basis(z, corrected)
        derivatives = (basis(z + step, corrected) - basis(z - step, corrected)) / (2 * step)
        assert scale(slopes - derivatives[0]) < mp.mpf(10) ** -30
        residual = equation_4([values, slopes, derivatives[1]], qx, qy, ratio(nu))
        for bound in (WRONG, mp.mpf(10) ** -30):
            assert [n for n in range(6) if scale(residual[:, n]) > bound] == wrong


def bonded_by_the_paper(mode, rows_corrected=True, basis_corrected=True):
    """u at the top of a bonded layer under σ_zz = −1 and σ_zx = 1/2, by Eqs. 5, 6 and 7.

    The shear is needed because a pressure alone is not affected by the exchanged rows of Eq. 7.
    """
    qx, qy, height, young, nu = mode
    bottom, _ = printed.basis(mp, qx, qy, mp.mpf(0), ratio(nu), basis_corrected)
    top, slopes = printed.basis(mp, qx, qy, height, ratio(nu), basis_corrected)
    stress = printed.stress_rows(top, slopes, qx, qy, young, nu, rows_corrected)
    amplitudes = mp.lu_solve(mp.matrix(bottom + stress), mp.matrix([0, 0, 0, -1, 0, mp.mpf("0.5")]))
    return np.array(top) @ np.array(list(amplitudes))


def test_equations_5_to_7_solve_the_layer(mode):
    qx, qy, height, young, nu = mode
    solid = StateSpace(qx, qy, young, nu, height, digits=60)
    true = solid.state(0, solid.solve([mp.mpf("0.5"), 0, -1]))[:3]
    assert scale(bonded_by_the_paper(mode) - true) < EXACT * scale(true)
    for printed_part in ({"rows_corrected": False}, {"basis_corrected": False}):
        assert scale(bonded_by_the_paper(mode, **printed_part) - true) > WRONG * scale(true)


def test_equation_6_fails_for_incompressible_solids(mode):
    """The determinant of Eq. 5 at the two faces falls as s²; the problem is not singular at ν = 1/2."""
    qx, qy, height, _, _ = mode

    def determinant(nu):
        rows = [row for z in (mp.mpf(0), height) for row in printed.basis(mp, qx, qy, z, ratio(nu))[0]]
        return abs(mp.det(mp.matrix(rows)))

    small, smaller = (determinant(mp.mpf(1) / 2 - mp.mpf(10) ** -n) for n in (8, 9))
    assert small / smaller == pytest.approx(100, rel=1e-5)
    assert determinant(mp.mpf(1) / 2) < EXACT


def test_equation_10_holds(mode):
    """Displacements per traction t_z; t_z = 1 is the pressure −1."""
    qx, qy, _, young, nu = mode
    square = qx**2 + qy**2
    shear = 1j * (nu + 1) * (2 * nu - 1) / (young * square)
    printed_form = np.array([shear * qx, shear * qy, -2 * (nu**2 - 1) / (young * mp.sqrt(square))])
    true = -StateSpace(qx, qy, young, nu, digits=60).displacement(0)
    assert scale(printed_form - true) < EXACT * scale(true)


# Element -> its entry (row, column).
ENTRIES = {f"{row}{column}": (row - 1, column - 1) for row in range(1, 4) for column in range(row, 4)}
ENTRIES |= {"14": (0, 3), "15": (0, 4), "16": (0, 5), "25": (1, 4), "26": (1, 5), "36": (2, 5)}


def test_equation_a3(mode, faces):
    right, literal = (printed.compliance_elements(mp, *mode, corrected=c) for c in (True, False))
    assert set(right) == set(ENTRIES)
    wrong = set()
    for element, at in ENTRIES.items():
        factor = 1j if element in ("13", "23", "16", "26") else 1
        true, size = (part[at] for part in faces)
        assert abs(factor * right[element] - true) < EXACT * size
        difference = abs(factor * literal[element] - true)
        assert not EXACT * size < difference < WRONG * size
        wrong |= {element} if difference > WRONG * size else set()
    assert wrong == {"11", "12", "22", "33", "36", "16", "26"}


def test_equation_a2(mode, faces):
    true, size = faces
    literal = np.array(printed.compliance(printed.compliance_elements(mp, *mode)))
    assert np.argwhere(abs(literal - true) > EXACT * size).tolist() == [[4, 3], [5, 3], [5, 4]]


HOLD = {(2, 0), (2, 1), (3, 0), (3, 1), (4, 0), (4, 1)}
"""Of the 21 elements on and below the diagonal those that A.2 and A.3 give as printed."""


@pytest.mark.parametrize("place", [(row, column) for row in range(6) for column in range(row + 1)])
def test_green_tensor_has_the_corrected_elements(mode, faces, place):
    """8e-15: rounding of the library and of the mode; the first mode has ν > 0, the second ν < 0."""
    qx, qy, height, young, nu = map(float, mode)
    true, size = (part[place] for part in faces)
    found = complex(Solid(young, nu, height).green_tensor(qx, qy)[place])
    assert abs(found - true) < 8e-15 * size
    literal = printed.compliance(printed.compliance_elements(mp, *mode, corrected=False))
    assert (abs(literal[place[0]][place[1]] - found) < 8e-15 * size) == (place in HOLD)


def test_tractions_are_those_on_outward_normals(faces):
    """With t_i = σ_iz on both faces the compliance would not be Hermitian."""
    true, size = faces
    inward = true * np.array([1, 1, 1, -1, -1, -1])
    assert np.all(abs(true - true.conj().T) < EXACT * size)
    assert scale(inward - inward.conj().T) > WRONG * scale(true)


def test_equation_18_is_critical_as_corrected():
    """Printed is (2/Δt) √(κ − κ), no damping; κ is the stiffness of a mode of unit mass times Δt².

    One step is of position Störmer–Verlet with centred damping.
    """
    time_step, stiffness = 0.8, 0.9
    kappa = stiffness * time_step**2

    def spectral_radius(damping):
        g = damping * time_step / 2
        return np.abs(np.linalg.eigvals([[(2 - kappa) / (1 + g), -(1 - g) / (1 + g)], [1, 0]])).max()

    critical = 2 / time_step * np.sqrt(kappa - kappa**2 / 4)
    # A double root: the radius rises like a square root on one side, linearly on the other.
    assert spectral_radius(critical) < min(spectral_radius(part * critical) for part in (0.99, 1.01))
    assert spectral_radius(0.0) == pytest.approx(1)


def test_equation_12_grows_without_limit():
    """Every neighbour at distance r adds about 4 a³/(3 r), and there are r of them."""
    sums = []
    for n in (10, 20, 40, 80):
        k = np.arange(-n, n + 1)
        r = np.hypot(k[:, None], k[None, :])
        r, e = r[r > 0], 0.2 / r[r > 0]
        sums.append(np.sum(r**2 * ((2 * e**2 - 1) * np.arcsin(e) + e * np.sqrt(1 - e**2))))
    growth = np.diff(sums)
    np.testing.assert_allclose(growth[1:] / growth[:-1], 2, rtol=0.03)


def test_equation_21_gives_two_values_to_one_symbol():
    """Either line alone gives symmetric surfaces, h(−r) = h(r); without Δ(−q) = Δ(q)* they are not real."""
    number = np.fft.fftfreq(64, 1 / 64)
    wavenumber = np.maximum(np.hypot(number[:, None], number), 1)
    amplitude = np.where((wavenumber >= 2) & (wavenumber <= 16), wavenumber**-1.8, 0)
    first, second = 1 - np.random.default_rng(1).random((2, 64, 64))
    whole = np.sqrt(-2 * np.log(first)) * np.exp(2j * np.pi * second)
    assert np.mean(np.abs(whole.real - whole.imag)) > 1

    def reflected(values):
        """A field at −r, or coefficients at −q."""
        return np.roll(values[::-1, ::-1], 1, axis=(0, 1))

    for deviate, even in ((whole.real + 0j, True), (whole, False)):
        alone = np.fft.ifft2(amplitude * deviate)
        assert np.std(alone.imag) > 0.3 * np.std(alone.real)
        height = np.fft.ifft2(amplitude * (deviate + reflected(deviate).conj()))
        assert np.abs(height.imag).max() < 1e-14 * np.abs(height.real).max()
        same = np.corrcoef(height.real.ravel(), reflected(height.real).ravel())[0, 1]
        assert same == pytest.approx(1) if even else same < 0.9

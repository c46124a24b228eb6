"""Equations of the paper as printed and as corrected, against the independent high-precision solution.

For every correction the printed form differs from the independent solution by far more than rounding, and
the corrected form agrees with it to all digits.
"""

import mpmath as mp
import numpy as np
import pytest

from asperity.reference import printed
from asperity.reference.state_space import StateSpace
from asperity.surface.self_affine import self_affine

# Rounding of 60-digit arithmetic, with the digits lost in the solves.
EXACT = mp.mpf(10) ** -40
WRONG = 0.01

MODES = [(0.7, -1.1, 0.9, 2.3, 0.31), (2.0, 1.3, 0.4, 1.0, -0.4)]
"""q_x, q_y, height, Young's modulus, Poisson's ratio."""


@pytest.fixture(autouse=True)
def _digits():
    with mp.workdps(60):
        yield


def numbers(mode):
    return [mp.mpf(value) for value in mode]


def profile(mode, depth=0.3, bottom="bonded"):
    """Displacement of the independent solution and its first two derivatives along z."""
    qx, qy, height, young, nu = numbers(mode)
    solid = StateSpace(qx, qy, young, nu, height, bottom, digits=60)
    state = solid.state(height * depth)
    slope = solid.system * state
    return [list(y[0:3]) for y in (state, slope, solid.system * slope)]


def scale(values):
    return max(abs(value) for value in values)


@pytest.mark.parametrize("mode", MODES)
def test_equation_3(mode):
    qx, qy, _, young, nu = numbers(mode)
    c11, c12, c44 = printed.elastic_constants(young, nu)
    (ux, uy, uz), (ux1, uy1, uz1), (ux2, uy2, uz2) = u = profile(mode)
    x, y, mixed = 1j * qx, 1j * qy, c12 + c44
    along_x = c11 * x * x * ux + mixed * (x * y * uy + x * uz1)
    along_z = c11 * uz2 + mixed * (y * uy1 + x * ux1)
    first = c44 * (y * y * ux + ux2) + along_x
    first_printed = c44 * (x * x * ux + y * y * ux) + along_x
    second = c44 * (x * x * uy + uy2) + c11 * y * y * uy + mixed * (x * y * ux + y * uz1)
    third = c44 * (x * x * uz + y * y * uz) + along_z
    third_printed = c44 * (x * x * uz + uz2) + along_z
    size = young * (qx**2 + qy**2) * scale(u[0])
    assert scale([first, second, third]) < EXACT * size
    assert min(abs(first_printed), abs(third_printed)) > WRONG * size


def equilibrium_of_mode(displacement, qx, qy, s):
    """Left-hand sides of the three lines of Eq. 4 from the displacement and its derivatives along z."""
    (ux, uy, uz), (ux1, uy1, uz1), (ux2, uy2, uz2) = displacement
    x, y = 1j * qx, 1j * qy
    return [
        s * (y * y * ux + x * y * uy + x * uz1 + ux2) + (1 - 2 * s) * (x * y * uy + x * uz1) + x * x * ux,
        s * (x * x * uy + x * y * ux + y * uz1 + uy2) + (1 - 2 * s) * (x * y * ux + y * uz1) + y * y * uy,
        s * (x * x * uz + y * y * uz + x * ux1 + y * uy1) + uz2 + (1 - 2 * s) * (x * ux1 + y * uy1),
    ]


@pytest.mark.parametrize("mode", MODES)
def test_equation_4_holds(mode):
    qx, qy, _, _, nu = numbers(mode)
    u = profile(mode)
    residual = equilibrium_of_mode(u, qx, qy, (1 - 2 * nu) / (2 * (1 - nu)))
    assert scale(residual) < EXACT * (qx**2 + qy**2) * scale(u[0])


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("column", range(6))
def test_equation_6_solves_equation_4_without_f34(mode, column):
    qx, qy, _, _, nu = numbers(mode)
    s = (1 - 2 * nu) / (2 * (1 - nu))
    z = mp.mpf("0.37")

    def residual(corrected):
        with mp.workdps(90):

            def element(row, order, at):
                return printed.basis(mp, qx, qy, at, s, corrected)[order][row][column]

            values = [element(row, 0, z) for row in range(3)]
            slopes = [element(row, 1, z) for row in range(3)]
            curvatures = [mp.diff(lambda at, row=row: element(row, 1, at), z) for row in range(3)]
            return scale(equilibrium_of_mode([values, slopes, curvatures], qx, qy, s))

    # Rounding of the numerical derivative of the analytical slopes.
    assert residual(True) < mp.mpf(10) ** -30
    if column == 3:
        assert residual(False) > WRONG
    else:
        assert residual(False) < mp.mpf(10) ** -30


def test_equation_6_slopes_are_derivatives():
    qx, qy, _, _, nu = numbers(MODES[0])
    s = (1 - 2 * nu) / (2 * (1 - nu))
    z = mp.mpf("0.37")
    for row in range(3):
        for column in range(6):
            slope = mp.diff(lambda at, r=row, c=column: printed.basis(mp, qx, qy, at, s)[0][r][c], z)
            assert abs(slope - printed.basis(mp, qx, qy, z, s)[1][row][column]) < mp.mpf(10) ** -25


def bonded_by_the_paper(mode, rows_corrected=True, basis_corrected=True):
    """u at the top of a bonded layer under σ_zz = −1 and σ_zx = 1/2, by Eqs. 5, 6 and 7.

    The shear is needed because a pressure alone is not affected by the exchanged rows of Eq. 7.
    """
    qx, qy, height, young, nu = numbers(mode)
    s = (1 - 2 * nu) / (2 * (1 - nu))
    bottom, _ = printed.basis(mp, qx, qy, mp.mpf(0), s, basis_corrected)
    top, slopes = printed.basis(mp, qx, qy, height, s, basis_corrected)
    stress = printed.stress_rows(top, slopes, qx, qy, young, nu, rows_corrected)
    amplitudes = mp.lu_solve(mp.matrix(bottom + stress), mp.matrix([0, 0, 0, -1, 0, mp.mpf("0.5")]))
    return mp.matrix(top) * amplitudes


@pytest.mark.parametrize("mode", MODES)
def test_equations_5_to_7_solve_the_layer(mode):
    qx, qy, height, young, nu = numbers(mode)
    solid = StateSpace(qx, qy, young, nu, height, digits=60)
    true = solid.state(0, solid.solve([mp.mpf("0.5"), 0, -1]))[0:3]
    size = scale(true)
    assert scale(bonded_by_the_paper(mode) - true) < EXACT * size
    assert scale(bonded_by_the_paper(mode, rows_corrected=False) - true) > WRONG * size
    assert scale(bonded_by_the_paper(mode, basis_corrected=False) - true) > WRONG * size


def test_equation_6_fails_for_incompressible_solids():
    """The determinant of Eq. 5 at the two faces falls as s²; the problem is not singular at ν = 1/2."""
    qx, qy, height, _, _ = numbers(MODES[0])

    def determinant(nu):
        s = (1 - 2 * nu) / (2 * (1 - nu))
        rows = printed.basis(mp, qx, qy, mp.mpf(0), s)[0] + printed.basis(mp, qx, qy, height, s)[0]
        return abs(mp.det(mp.matrix(rows)))

    small, smaller = (determinant(mp.mpf(1) / 2 - mp.mpf(10) ** -n) for n in (8, 9))
    assert small / smaller == pytest.approx(100, rel=1e-5)
    assert determinant(mp.mpf(1) / 2) < EXACT


@pytest.mark.parametrize("mode", MODES)
def test_equation_10_holds(mode):
    qx, qy, _, young, nu = numbers(mode)
    solid = StateSpace(qx, qy, young, nu, digits=60)
    # A traction t_z = 1 is the pressure −1.
    true = -solid.state(0)[0:3]
    square = qx * qx + qy * qy
    shear = 1j * (nu + 1) * (2 * nu - 1) / (young * square)
    eq_10 = mp.matrix([shear * qx, shear * qy, -2 * (nu**2 - 1) / (young * mp.sqrt(square))])
    assert scale(eq_10 - true) < EXACT * scale(true)


def face_compliance(mode):
    qx, qy, height, young, nu = numbers(mode)
    return StateSpace(qx, qy, young, nu, height, "free", digits=60).compliance()


# Element -> its entry (row, column), factor included
ENTRIES = {
    "11": (0, 0, 1),
    "12": (0, 1, 1),
    "13": (0, 2, 1j),
    "22": (1, 1, 1),
    "23": (1, 2, 1j),
    "33": (2, 2, 1),
    "14": (0, 3, 1),
    "15": (0, 4, 1),
    "16": (0, 5, 1j),
    "25": (1, 4, 1),
    "26": (1, 5, 1j),
    "36": (2, 5, 1),
}


@pytest.mark.parametrize("mode", MODES)
@pytest.mark.parametrize("element", ENTRIES)
def test_equation_a3(mode, element):
    true = face_compliance(mode)
    row, column, factor = ENTRIES[element]
    literal, right = (
        factor * printed.compliance_elements(mp, *numbers(mode), corrected=c)[element] for c in (False, True)
    )
    size = mp.sqrt(abs(true[row, row] * true[column, column]))
    assert abs(right - true[row, column]) < EXACT * size
    if element in ("11", "12", "22", "33", "36", "16", "26"):
        assert abs(literal - true[row, column]) > WRONG * size
    else:
        assert abs(literal - true[row, column]) < EXACT * size


@pytest.mark.parametrize("mode", MODES)
def test_equation_a2(mode):
    true = face_compliance(mode)
    elements = printed.compliance_elements(mp, *numbers(mode))
    right, literal = (mp.matrix(printed.compliance(elements, c)) for c in (True, False))
    wrong = []
    for row in range(6):
        for column in range(6):
            size = mp.sqrt(abs(true[row, row] * true[column, column]))
            assert abs(right[row, column] - true[row, column]) < EXACT * size
            if abs(literal[row, column] - true[row, column]) > EXACT * size:
                wrong.append((row + 1, column + 1))
    assert wrong == [(5, 4), (6, 4), (6, 5)]


@pytest.mark.parametrize("mode", MODES)
def test_tractions_are_those_on_outward_normals(mode):
    """With t_i = σ_iz on both faces the compliance would not be Hermitian."""
    true = face_compliance(mode)
    size = scale(true)
    assert scale(true - true.transpose_conj()) < EXACT * size
    inward = true * mp.diag([1, 1, 1, -1, -1, -1])
    assert scale(inward - inward.transpose_conj()) > WRONG * size


def spectral_radius(time_step, stiffness, damping):
    """Spectral radius of one step of position Störmer–Verlet with centred damping and unit mass."""
    g = damping * time_step / 2
    step = [[(2 - stiffness * time_step**2) / (1 + g), -(1 - g) / (1 + g)], [1, 0]]
    return np.abs(np.linalg.eigvals(step)).max()


def test_equation_18_is_critical_as_corrected():
    time_step, stiffness = 0.8, 0.9
    kappa = stiffness * time_step**2
    critical = 2 / time_step * np.sqrt(kappa - kappa**2 / 4)  # printed κ − κ
    fastest = spectral_radius(time_step, stiffness, critical)
    # A double root: the radius rises like a square root on one side, linearly on the other.
    assert fastest < spectral_radius(time_step, stiffness, 0.99 * critical)
    assert fastest < spectral_radius(time_step, stiffness, 1.01 * critical)
    assert spectral_radius(time_step, stiffness, 0.0) == pytest.approx(1)


def test_equation_12_grows_without_limit():
    """Every neighbour at distance r adds about 4 a³/(3 r), and there are r of them."""
    a = 0.2

    def partial_sum(n):
        k = np.arange(-n, n + 1)
        r = np.hypot(k[:, None], k[None, :])
        r = r[r > 0]
        e = a / r
        return np.sum(r**2 * ((2 * e**2 - 1) * np.arcsin(e) + e * np.sqrt(1 - e**2)))

    sums = np.array([partial_sum(n) for n in (10, 20, 40, 80)])
    growth = np.diff(sums)
    np.testing.assert_allclose(growth[1:] / growth[:-1], 2, rtol=0.03)


def reflected(values):
    """A field at −r, or coefficients at −q."""
    return np.roll(values[::-1, ::-1], 1, axis=(0, 1))


def test_equation_21_gives_two_values_to_one_symbol():
    """Either line alone gives symmetric surfaces, h(−r) = h(r); without Δ(−q) = Δ(q)* they are not real."""
    number = np.fft.fftfreq(64, 1 / 64)
    wavenumber = np.maximum(np.hypot(number[:, None], number), 1)
    amplitude = np.where((wavenumber >= 2) & (wavenumber <= 16), wavenumber**-1.8, 0)
    uniform = 1 - np.random.default_rng(1).random((2, 64, 64))
    radius = np.sqrt(-2 * np.log(uniform[0]))
    cosine, sine = radius * np.cos(2 * np.pi * uniform[1]), radius * np.sin(2 * np.pi * uniform[1])
    assert np.mean(np.abs(cosine - sine)) > 1
    whole = cosine + 1j * sine
    for deviate, even in ((cosine + 0j, True), (whole, False)):
        alone = np.fft.ifft2(amplitude * deviate)
        assert np.std(alone.imag) > 0.3 * np.std(alone.real)
        height = np.fft.ifft2(amplitude * (deviate + reflected(deviate).conj()))
        assert np.abs(height.imag).max() < 1e-14 * np.abs(height.real).max()
        same = np.corrcoef(height.real.ravel(), reflected(height.real).ravel())[0, 1]
        assert same == pytest.approx(1) if even else same < 0.9


def test_surfaces_follow_equation_21():
    """About 3200 independent waves; bounds: four standard errors."""
    height = self_affine((256, 256), 0.8, 1 / 2, 1 / 64, 1e-3, seed=1)
    number = np.fft.fftfreq(256, 1 / 256)
    ky, kx = np.meshgrid(number, number, indexing="ij")
    size = np.hypot(ky, kx)
    half = ((kx > 0) | ((kx == 0) & (ky > 0))) & (size >= 2) & (size <= 64)
    deviate = np.fft.fft2(height)[half] * size[half] ** 1.8
    deviate /= np.sqrt(np.mean(np.abs(deviate) ** 2) / 2)
    bound = 4 / np.sqrt(half.sum())
    for part in (deviate.real, deviate.imag):
        assert np.mean(part) == pytest.approx(0, abs=bound)
        assert np.mean(part**2) == pytest.approx(1, abs=np.sqrt(2) * bound)
        assert np.mean(part**4) == pytest.approx(3, abs=np.sqrt(96) * bound)
    assert np.mean(deviate.real * deviate.imag) == pytest.approx(0, abs=bound)

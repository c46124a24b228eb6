"""Coatings and stacks of layers against high precision, finite elements, limits, and direct contacts."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest
import skfem
from layered_mode import LayeredMode
from samples import difference, refuses
from solution_check import mode_compliance

import asperity as asp
from asperity.contact.sparse_inverse import SparseInverse, influence
from asperity.elasticity.loaded_solid import layer_of, solid_of
from asperity.elasticity.solid import MANY
from asperity.reference.pivoting import pivot

ACCURACY = 1e-12
"""Largest error over the largest component at a depth; the largest of 300 stacks was 5e-14."""
ROUNDING = 4e-14
"""The same of one coating: 1e-15, but 2e-14 in a thin and stiff one."""

BASE = asp.Solid(1.0, 0.3)
COATED = asp.Solid(4.0, 0.2, 0.02, base=BASE)
SANDWICH = asp.Solid.stack([(0.02, 4.0, 0.2), (0.01, 0.1, 0.5), (0.03, 30.0, 0.25)], base=BASE)


def random_stack(seed):
    """1 to 8 layers of q height 1e-6 to 1e3, ratios of moduli to 1e6, on each kind of base."""
    random = np.random.default_rng(seed)
    count, low, high = 1 + seed % 8, *((-6, 3) if seed % 3 else (-3, 1))
    # Depths of interfaces are sums without rounding, as the positions in thin and deep layers have to be.
    heights = np.ceil(10 ** random.uniform(low, high, count) * 2**38) / 2**38
    young = 10 ** (random.uniform(-3, 3, count) if seed % 2 else random.choice([0.0, 6.0], count))
    poisson = random.choice([0.5, 0.4999999, 0.3, 0.0, -0.5, -0.9], count)
    layers = list(zip(heights.tolist(), young.tolist(), poisson.tolist(), strict=True))
    if kind := seed // 2 % 3:
        return asp.Solid.stack(layers, bottom=("bonded", "frictionless")[kind - 1])
    return asp.Solid.stack(layers, base=asp.Solid(1.0, 0.5))


def depths_of(solid):
    """Both faces of every interface, and places between them, to q depth = 600."""
    faces = np.array([0.0, *solid.interfaces, solid.extent or solid.interfaces[-1] + 2])
    found = [*faces, *np.nextafter(faces[1:-1], np.inf), *(faces[:-1] + 0.3 * np.diff(faces))]
    return [depth for depth in np.unique(found) if depth < 600]


def coatings():
    """Coatings of q height 1e-6 to 1e6 and ratios of moduli to 1e6."""
    ratios = {1e-6: (0.5, -0.9), 0.3: (0.2, 0.5), 3.0: (-0.9, 0.25), 1e6: (0.3, 0.0)}
    for height in (1e-6, 1e-3, 0.05, 0.999, 1.001, 8.0, 1e6):
        for contrast, (nu, nu_base) in ratios.items():
            yield asp.Solid(contrast, nu, height, base=asp.Solid(1.0, nu_base))


@pytest.mark.parametrize(
    ("solid", "accuracy"),
    [*((random_stack(seed), ACCURACY) for seed in range(12)), *((solid, ROUNDING) for solid in coatings())],
)
def test_modes_are_exact(solid, accuracy):
    """Compliance, stress and displacement under a pressure, and stress under both shear tractions."""
    mode, q = LayeredMode(0.6, 0.8, solid), np.hypot(0.6, 0.8)
    surface = mode.at(0)[1]
    assert solid.surface_compliance(q) == pytest.approx(-float(surface[2].real), rel=accuracy / 10)
    for depth in depths_of(solid):
        stress, displacement = mode.at(depth)
        found = max(abs(solid.stress(0.6, 0.8, depth) - stress))
        assert found < accuracy * (1 + depth) * max(abs(stress))
        # Next to a stiff base all components vanish.
        found = max(abs(solid.displacement(0.6, 0.8, depth) - displacement))
        assert found < accuracy * (1 + depth) * max(*abs(displacement), max(abs(surface)) * mp.exp(-depth))
    if solid.parts[-1].bottom == "frictionless":
        return
    for top in ([1, 0, 0], [0, 1, 0]):
        mode = LayeredMode(1, 0, solid, top)
        for depth in depths_of(solid):
            n, m, x, p, q = (float(kernel) for kernel in solid.shear_kernels(1.0, depth))
            own = solid.part_at(depth).poisson
            stress = [1j * m, 1j * own * (m + n), 1j * n, 0, x, 0] if top[0] else [0, 0, 0, p, 0, 1j * q]
            exact = mode.at(depth)[0]
            assert max(abs(np.array(stress) - exact)) < accuracy * (1 + depth) * max(abs(exact))


def closed_forms(bottom, h, d, nu):
    """Z, L, T, V and W of ``paper/supplement/method.md``, to 60 digits."""
    h, d, nu = mp.mpf(h), mp.mpf(d), mp.mpf(nu)
    t, m, m1, k = h - d, 1 - 2 * nu, 2 - 2 * nu, 3 - 4 * nu
    (sh, st, sd), (ch, ct, cd) = ([f(x) for x in (h, t, d)] for f in (mp.sinh, mp.cosh))
    if bottom == "frictionless":
        n = sh * ch + h
        z = (sh * ct + d * ch * ct + t * cd) / n
        along = (sh * ct - d * ch * ct - t * cd) / n
        shear = (d * ch * st - t * sd) / n
        return z, along, shear, (1 - nu) * along - nu * z, shear + m1 * sh * st / n
    n = h * h + m1 * m1 + k * sh * sh
    z = ((h * t + m * m) * cd + k * ch * ct + d * (m1 * sh * ct + m * ch * st) + t * sd) / n
    shear = (d * (m1 * ch * ct + m * sh * st) - (h * t + m * m1) * sd) / n
    v = (k * (m * sh * st - d * ch * st) + t * (m * sd - h * cd)) / n
    w = (k * (m1 * ch * st + d * sh * st) - t * (m1 * cd + h * sd)) / n
    return z, (v + nu * z) / (1 - nu), shear, v, w


@pytest.mark.parametrize("nu", [-0.9, 0.3, 0.5])
@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_one_layer_has_the_closed_forms(bottom, nu):
    with mp.workdps(60):
        for h in (1e-6, 0.03, 0.999, 1.001, 8.0, 40.0):
            for d in (0.0, 0.25 * h, 0.75 * h, h):
                exact = closed_forms(bottom, h, d, nu)
                found = asp.Solid(1.0, nu, h, bottom).kernels(1.0, d)
                for kinds in (slice(0, 3), slice(3, 5)):
                    scale = max(abs(value) for value in exact[kinds])
                    for ours, theirs in zip(found[kinds], exact[kinds], strict=True):
                        assert abs(float(ours) - theirs) <= 4e-15 * (1 + d) * scale


@pytest.mark.parametrize("bottom", ["bonded", "frictionless"])
def test_a_layer_may_be_divided(bottom):
    whole = asp.Solid(2.0, 0.3, 0.75, bottom)
    parts = asp.Solid.stack([(h, 2.0, 0.3) for h in (0.125, 0.5, 0.125)], bottom=bottom)
    q, depth = np.geomspace(1e-3, 1e2, 40)[:, None], np.linspace(0, 0.75, 13)
    for ours, theirs in zip(parts.kernels(q, depth), whole.kernels(q, depth), strict=True):
        np.testing.assert_allclose(ours, theirs, atol=1e-14)
    for lateral in ("confined", "free"):
        one, many = (asp.Solid.stack(s.layers, bottom=bottom, lateral=lateral) for s in (whole, parts))
        np.testing.assert_allclose(many.uniform_stress(depth), one.uniform_stress(depth), atol=1e-15)
        np.testing.assert_allclose(many.uniform_displacement(depth), one.uniform_displacement(depth))


def finite_elements(coating):
    """Depths, σ_xx, σ_zz, σ_xz and u_z under a pressure cos x, by quadratic elements along the depth."""
    half = np.concatenate([[0], np.geomspace(1e-3, 25, 150)])
    edges = np.unique(np.concatenate([np.linspace(0, coating.height, 61), coating.height + half]))
    basis = skfem.Basis(skfem.MeshLine(edges), skfem.ElementVector(skfem.ElementLineP2(), 2), intorder=5)

    def constants(depth):
        inside = depth <= coating.height
        young = np.where(inside, coating.young, coating.base.young)
        nu = np.where(inside, coating.poisson, coating.base.poisson)
        return young / (2 * (1 + nu)), young * nu / ((1 + nu) * (1 - 2 * nu))

    def strains(field):
        """In plane strain, of the displacements U sin x and W cos x, W downward."""
        return field[0], field.grad[1, 0], field.grad[0, 0] - field[1]

    @skfem.BilinearForm
    def stiffness(u, v, w):
        shear, first = constants(w.x[0])
        (uxx, uzz, uxz), (vxx, vzz, vxz) = strains(u), strains(v)
        return first * (uxx + uzz) * (vxx + vzz) + 2 * shear * (uxx * vxx + uzz * vzz) + shear * uxz * vxz

    load = np.zeros(basis.N)
    load[basis.nodal_dofs[1, 0]] = 1.0
    held = basis.nodal_dofs[:, -1]
    solution = skfem.solve(*skfem.condense(stiffness.assemble(basis), load, D=held))
    field, depth = basis.interpolate(solution), np.asarray(basis.global_coordinates())[0]
    shear, first = constants(depth)
    xx, zz, xz = strains(field)
    stress = [first * (xx + zz) + 2 * shear * xx, first * (xx + zz) + 2 * shear * zz, shear * xz]
    near = depth < 5
    return depth[near], *(np.asarray(values)[near] for values in (*stress, -field[1]))


@pytest.mark.parametrize(("contrast", "nu", "height"), [(4.0, 0.2, 0.5), (0.1, 0.45, 1.5)])
def test_finite_elements_agree(contrast, nu, height):
    coating = asp.Solid(contrast, nu, height, base=BASE)
    depth, *expected = finite_elements(coating)
    stress = coating.stress(1.0, 0.0, depth)
    found = (
        stress[:, 0].real,
        stress[:, 2].real,
        stress[:, 4].imag,
        coating.displacement(1.0, 0.0, depth)[:, 2].real,
    )
    for ours, theirs in zip(found, expected, strict=True):
        # Discretisation of the stress, largest where the elements grow: 3e-4.
        assert abs(ours - theirs).max() < 1e-3 * abs(theirs).max()


def test_limits_of_the_base():
    """A base like its layers, a rigid one and none at all."""
    q, depth = np.geomspace(1e-3, 1e2, 40)[:, None], np.linspace(0, 0.7, 8)
    own, half_space = asp.Solid(2.0, 0.3, 0.7), asp.Solid(2.0, 0.3)
    alike = asp.Solid.stack([(0.1, 2.0, 0.3), (0.6, 2.0, 0.3)], base=half_space)
    rigid = asp.Solid(2.0, 0.3, 0.7, base=asp.Solid(1e20, 0.2))
    np.testing.assert_allclose(alike.surface_compliance(q), half_space.surface_compliance(q), rtol=4e-15)
    for found, expected, depths in ((alike, half_space, 3 * depth), (rigid, own, depth)):
        for kernels in ("kernels", "shear_kernels"):
            ours, theirs = (getattr(solid, kernels)(q, depths) for solid in (found, expected))
            np.testing.assert_allclose(ours, theirs, atol=4e-15)
    plate = asp.Solid(2.0, 0.3, 0.7, "free")
    loose = asp.Solid(2.0, 0.3, 0.7, base=asp.Solid(1e-30, 0.3))
    np.testing.assert_allclose(loose.surface_compliance(q), plate.surface_compliance(q), rtol=4e-15)


@pytest.mark.parametrize("base", [None, BASE])
@pytest.mark.parametrize("lateral", ["confined", "free"])
def test_mean_mode_follows_hooke(lateral, base):
    """One lateral strain; none if confined, and otherwise no net lateral force."""
    layers = [(0.2, 4.0, 0.2), (0.1, 0.1, 0.5), (0.3, 30.0, -0.4)]
    solid = asp.Solid.stack(layers, base=base, lateral=lateral)
    faces = np.cumsum([0.0, *(layer[0] for layer in layers)])
    middles = 0.5 * (faces[1:] + faces[:-1])
    height, young, poisson = np.array(layers).T
    stress = solid.uniform_stress(middles)
    strain = (stress[:, 0] - poisson * (stress[:, 1] + stress[:, 2])) / young
    below = 0.0
    if lateral == "free":
        below = np.mean(strain)
        if base is None:
            assert abs(height @ stress[:, 0]) < 1e-15
        else:
            assert solid.uniform_stress(1.0)[0] == 0
            below = BASE.poisson / BASE.young
    np.testing.assert_allclose(strain, below, atol=1e-15)
    if base is None:
        vertical = (stress[:, 2] - poisson * (stress[:, 0] + stress[:, 1])) / young
        moved = solid.uniform_displacement(faces)
        np.testing.assert_allclose(np.diff(moved), -height * vertical, atol=1e-15)
        assert solid.uniform_compliance() == -moved[0]
        assert moved[-1] == 0
        along = sum(2 * (1 + nu) * h / e for h, e, nu in layers)
        np.testing.assert_allclose(solid.tangential_compliance([0.0]), along)


def test_layers_and_interfaces():
    assert SANDWICH.layers == ((0.02, 4.0, 0.2), (0.01, 0.1, 0.5), (0.03, 30.0, 0.25))
    assert SANDWICH.interfaces == pytest.approx((0.02, 0.03, 0.06))
    assert SANDWICH.interface == 0.02
    assert SANDWICH.extent is None
    inner = asp.Solid(30.0, 0.25, 0.03, base=BASE)
    nested = asp.Solid(4.0, 0.2, 0.02, base=asp.Solid(0.1, 0.5, 0.01, base=inner))
    assert nested == SANDWICH
    slab = asp.Solid.stack([(0.2, 1.0, 0.3), (0.1, 2.0, 0.3)], bottom="frictionless", lateral="free")
    assert slab.interfaces == (0.2,)
    assert slab.extent == pytest.approx(0.3)
    assert slab.base.lateral == "free"
    assert (BASE.layers, BASE.interfaces) == ((), ())
    assert slab.description == "2 layers, layer, frictionless bottom"


TWO = [(1.0, 1.0, 0.3), (1.0, 1.0, 0.3)]

test_wrong_stacks_are_refused = refuses(
    (lambda: asp.Solid.stack([]), "layers: one"),
    (lambda: asp.Solid.stack([(1.0, 2.0)]), r"layers: \(1.0, 2.0\) is no"),
    (lambda: asp.Solid.stack(TWO, bottom="free"), "base = Solid.*: one whose bottom is not free"),
    (lambda: asp.Solid.stack(TWO, base="steel", bottom="free"), "base = 'steel'"),
    (lambda: asp.Solid(1.0, 0.3, 1.0, "frictionless", base=SANDWICH), "bottom = 'frictionless': bonded"),
    (lambda: asp.Solid(1.0, 0.3, base=SANDWICH), "height = None"),
    (lambda: SANDWICH.green_tensor(1.0, 0.0), "base = Solid.*: None is needed"),
    (lambda: asp.Solid.stack(TWO, bottom="frictionless").shear_kernels(1, 0), "bottom = 'frictionless'"),
    (lambda: asp.stress.depth_grid(asp.Grid((8, 8)), interface=(0.2, 0.1)), "interface = 0.1"),
)


@pytest.mark.parametrize("solid", [SANDWICH, asp.Solid(1.0, 0.5, 0.02), asp.Solid(1.0, 0.3, 0.1, "free")])
def test_many_wavenumbers_are_interpolated_to_rounding(solid):
    q = np.geomspace(1e-3, 1e5, MANY + 2)
    parts = np.array_split(q, 4)
    few = np.concatenate([solid.surface_compliance(part) for part in parts])
    np.testing.assert_allclose(solid.surface_compliance(q), few, rtol=4e-13)
    if solid.parts[-1].bottom == "free":
        return
    for kernels in (solid.kernels, solid.shear_kernels):
        for depth in (0.0, 0.013, 0.02):
            many = np.array(kernels(q, depth))
            few = np.concatenate([np.array(kernels(part, depth)) for part in parts], axis=1)
            scale = np.abs(few[:3]).max(axis=0) * (1 + q * depth)
            error, near = np.abs(many - few)[:3].max(axis=0), q * depth < 600
            assert (error[near] / scale[near]).max() < 2e-13


@pytest.fixture(scope="module")
def contact():
    height = asp.self_affine((64, 64), 0.8, 0.25, 0.25 / 8, rms_height=1e-3, seed=1)
    return asp.solve_contact(height, SANDWICH, contact_area_fraction=0.1)


@pytest.mark.parametrize("contrast", [1e-6, 1e-3, 30.0, 1e3, 1e6])
@pytest.mark.parametrize("thickness", [1e-3, 0.01, 0.1, 1.0])
@pytest.mark.parametrize(("nu", "area"), [(0.2, 0.02), (0.5, 0.45)])
def test_pressure_of_any_coating_is_direct(contrast, thickness, nu, area):
    require_direct(asp.Solid(contrast, nu, thickness, base=asp.Solid(1.0, 0.49)), area)


def test_pressure_of_a_stack_is_direct():
    require_direct(SANDWICH, 0.1)


def require_direct(solid, area):
    """Solver error, ten tolerances of 1e-6, of a contact on 24² nodes."""
    height = asp.self_affine((24, 24), 0.8, 0.5, 0.125, rms_height=1e-3, seed=10)
    contact = asp.solve_contact(height, solid, 1.0, contact_area_fraction=area)
    exact = pivot(height, mode_compliance(solid, contact.grid), mean_pressure=contact.mean_pressure)
    assert difference(contact.pressure, exact) < 1e-5


@pytest.mark.parametrize("layers", [SANDWICH.layers, COATED.layers])
@pytest.mark.parametrize("lateral", ["confined", "free"])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_stress_and_strain_on_every_interface(contact, layers, lateral, friction):
    """Tractions and the strains in the interface are continuous, the other stresses jump."""
    layer = asp.Solid.stack(layers, base=BASE, lateral=lateral)
    solid = asp.LoadedSolid(contact.pressure, contact.grid, layer)
    faces = [face for depth in layer.interfaces for face in (depth, np.nextafter(depth, 1))]
    names = ("xx", "yy", "zz", "yz", "xz", "xy")
    planes = list(asp.stress_planes(solid, faces, fields=names, tolerance=0, friction=friction))
    for number in range(len(layers)):
        strains, (upper, lower) = [], planes[2 * number : 2 * number + 2]
        scale = max(abs(plane.fields[name]).max() for plane in (upper, lower) for name in names)
        for part, plane in zip(layer.parts[number : number + 2], (upper, lower), strict=True):
            xx, yy, zz, _, _, xy = (plane.fields[name] for name in names)
            nu, young = part.poisson, part.young
            strains.append(np.stack([xx - nu * (yy + zz), yy - nu * (xx + zz), (1 + nu) * xy]) / young)
        softest = min(part.young for part in layer.parts[number : number + 2])
        assert abs(strains[0] - strains[1]).max() < 1e-12 * scale / softest
        for name in ("zz", "yz", "xz"):
            assert abs(upper.fields[name] - lower.fields[name]).max() < 1e-12 * scale
        assert abs(upper.fields["xx"] - lower.fields["xx"]).max() > 0.3 * scale


@pytest.mark.parametrize("solid", [SANDWICH, COATED])
def test_planes_and_peaks_at_every_interface(contact, solid):
    contact = replace(contact, solid=solid)
    stress = asp.analyse_stress(contact)
    depths = stress["plane_depth"].values
    section = set(asp.stress_section(contact, fields=("xx",))["depth"].values)
    peaks = asp.stress.select_peaks(stress, "von_mises")["peak_depth"].values
    for face in solid.interfaces:
        at = int(np.flatnonzero(depths == face)[0])
        assert depths[at + 1] == np.nextafter(face, np.inf)
        assert {depths[at], depths[at + 1]} <= section
        assert np.isin(depths[at : at + 2], peaks).all()
    bands = zip(solid.interfaces, solid.interfaces[1:], strict=False)
    assert all(np.count_nonzero((depths > a) & (depths <= b)) >= 4 for a, b in bands)


@pytest.mark.parametrize(
    "solid",
    [SANDWICH, *(asp.Solid(*of, base=BASE) for of in ((50, 0.3, 0.1), (4, 0.3, 0.02), (0.02, 0.3, 0.01)))],
)
def test_error_of_coarser_planes_is_below_its_bound(contact, solid):
    """The bound of the truncation in every material, and with it the tolerance."""
    depths = asp.stress.depth_grid(contact.grid, interface=solid.interfaces)
    names = ("xx", "zz", "xz", "von_mises", "principal_1")
    planes, exact = (
        asp.stress_planes(
            asp.LoadedSolid(contact.pressure, contact.grid, solid),
            [depth for depth in depths if 0.02 < depth < 0.5],
            fields=names,
            tolerance=tolerance,
            friction=0.3,
        )
        for tolerance in (1e-4, 0)
    )
    coarse = 0
    for plane, full in zip(planes, exact, strict=True):
        step, rest = divmod(full.grid.shape[0], plane.grid.shape[0])
        if plane.bound and not rest:
            coarse += 1
            for name in names:
                assert abs(plane.fields[name] - full.fields[name][:, ::step, ::step]).max() < plane.bound
            assert plane.bound < 1.001e-4 * np.sqrt(np.mean(full.fields["zz"] ** 2))
    assert coarse > 1


def test_a_result_keeps_its_layers(contact):
    data = contact.to_dataset()
    assert data.attrs["solid"] == "3 layers, half-space"
    kept, whole = layer_of(data), solid_of(data)
    assert kept.effective_modulus == pytest.approx(1)
    for found in (kept, whole):
        for name in ("young", "poisson", "thickness"):
            ours = np.array([getattr(layer, name) for layer in found.layers])
            theirs = np.array([getattr(layer, name) for layer in SANDWICH.layers])
            factor = found.young / SANDWICH.young if name == "young" else 1.0
            np.testing.assert_allclose(ours, theirs * factor)
    assert whole.young == pytest.approx(SANDWICH.young)


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize("contrast", [1e-3, 1.0, 1e2, 1e4])
def test_sparse_inverse_is_near_the_dense_one(contrast, mirrored):
    """Eigenvalues of M G; of a half-space's pressure alone they would span ten times the contrast."""
    from asperity.contact.response import response_on

    solid, grid = asp.Solid(contrast, 0.3, 1 / 24, base=BASE), asp.Grid((24, 20), mirrored=mirrored)
    response = response_on("periodic", solid, grid)
    nodes = np.flatnonzero(np.random.default_rng(1).random(grid.size) < 0.3).astype(np.uint32)
    kernel = influence(response)
    inverse = SparseInverse(kernel, grid.shape, nodes, 1)
    dense, sparse = np.empty((2, nodes.size, nodes.size))
    for number, node in enumerate(nodes):
        unit = np.zeros(grid.size)
        unit[node] = 1
        moved = response.displacement(unit.reshape(grid.shape)) / response.nodal_compliance
        dense[number] = moved.reshape(-1)[nodes] + kernel.mean() * (4 if mirrored else 1)
        sparse[number] = inverse(np.eye(nodes.size, dtype=np.float32)[number])
    assert difference(sparse, sparse.T) < 1e-5
    values = np.linalg.eigvals(sparse @ dense).real
    assert values.min() > 0.15
    assert values.max() < 6


@pytest.mark.parametrize("nu", [0.3, 0.5])
@pytest.mark.parametrize("load", [{"contact_area_fraction": 0.2}, {"mean_pressure": 2e-3}])
def test_stiff_film_as_thin_as_a_pixel(nu, load):
    """Contacts that ended with an error, or did not end, with a stencil as preconditioner."""
    height = asp.self_affine((64, 64), 0.8, 0.25, 1 / 16, rms_height=1e-3, seed=1)
    contact = asp.solve_contact(height, asp.Solid(1e4, nu, 1 / 64, base=BASE), 1.0, **load)
    assert contact.certificate.worst < 1e-4


def test_a_load_takes_as_many_iterations_under_a_stiff_film():
    height = asp.self_affine((128, 128), 0.8, 0.25, 1 / 32, rms_height=1e-3, seed=1)
    plain, *films = (
        asp.solve_contact(height, solid, mean_pressure=1e-3).certificate.iterations
        for solid in (BASE, *(asp.Solid(100.0, 0.3, spacings / 128, base=BASE) for spacings in (1, 2, 8)))
    )
    assert max(films) < 2 * plain


@pytest.mark.parametrize("ratio", [1e2, 1e4, 1e6, 1e8, 1e11])
@pytest.mark.parametrize("approach", [-5e-4, 1e-4, 2e-3, 0.049])
def test_a_stiff_layer_beyond_full_contact(ratio, approach):
    """The mean pressure exceeds all others by up to 1e11: pressure and certificate are exact to rounding."""
    height = np.zeros((14, 12))
    height[0, 0] = -1e-3
    pair = asp.TwoBodies(asp.Solid(1.9 * ratio, -0.28, 1.1), asp.Solid(1.9, 0.0))
    contact = asp.solve_contact(height, pair, (1.0, 0.36), approach=approach)
    assert contact.certificate.worst < 1e-2
    if approach > 0:
        mean = (approach - height.mean()) / pair.uniform_compliance()
        assert contact.contact_area_fraction == 1
        assert contact.mean_pressure == pytest.approx(mean, rel=1e-12)


@pytest.mark.parametrize("seed", [3, 10])
def test_stiff_coating_is_solved_as_by_gfmd(seed):
    """A hard film on a polymer in a wide contact: it bends between the contacts."""
    height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=seed)
    solid = asp.Solid(1.0, 0.2, 0.01, base=asp.Solid(0.01, 0.49))
    fast, damped = (
        asp.solve_contact(height, solid, mean_pressure=4.3e-5, method=method, rtol=1e-8)
        for method in ("active_set", "gfmd")
    )
    assert fast.certificate.iterations < 200
    assert np.linalg.norm(fast.pressure - damped.pressure) < 1e-6 * np.linalg.norm(damped.pressure)


@pytest.mark.parametrize("face", [1e-12, np.nextafter(3 / 128, 0), 0.5, 3.0])
def test_depths_hold_both_faces_of_the_interface_once(face):
    depths = asp.stress.depth_grid(asp.Grid((64, 64)), interface=face)
    at = np.flatnonzero(depths == face)[0]
    assert at >= 4
    assert np.all(np.diff(depths) > 0)
    assert np.flatnonzero(np.diff(depths) < 1e-9 * depths[1:]).tolist() == [at]
    assert depths[at + 1] == np.nextafter(face, np.inf)


def test_depths_end_at_the_lower_face_of_an_interface():
    """As for a coating as thick as the cell, whose planes end just below it."""
    below = np.nextafter(2.0, np.inf)
    depths = asp.stress.depth_grid(asp.Grid((8, 8)), below, interface=2.0)
    assert (np.diff(depths) > 0).all()
    assert depths[-2:].tolist() == [2.0, below]

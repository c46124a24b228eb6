"""The coated half-space against high precision, finite elements, its limits, and the interface conditions."""

import mpmath as mp
import numpy as np
import pytest
import skfem
from layered_mode import LayeredMode
from solution_check import mode_compliance

import asperity as asp
from asperity.reference.pivoting import pivot

ROUNDING = 4e-14
"""Largest error over the largest component at a depth: 1e-15, but 2e-14 in a thin and stiff coating."""

BASE = asp.Solid(1.0, 0.3)


def error(found, exact, depth):
    return float(max(abs(found - exact)) / max(abs(exact))) / (1 + depth)


@pytest.mark.parametrize("contrast", [1e-6, 0.3, 3.0, 1e6])
@pytest.mark.parametrize("height", [1e-6, 1e-3, 0.05, 0.999, 1.001, 8.0, 1e6])
def test_modes_are_exact_to_rounding(height, contrast):
    """Stress and displacement in both materials under a pressure, and stress under both shear tractions."""
    nu, nu_base = {1e-6: (0.5, -0.9), 0.3: (0.2, 0.5), 3.0: (-0.9, 0.25), 1e6: (0.3, 0.0)}[contrast]
    coating = asp.Solid(contrast, nu, height, base=asp.Solid(1.0, nu_base))
    below = np.nextafter(height, np.inf)
    depths = [depth for depth in (0.0, 0.3 * height, height, below, below + 2) if depth < 600]
    mode = LayeredMode(0.6, 0.8, coating)
    q = np.hypot(0.6, 0.8)
    assert coating.surface_compliance(q) == pytest.approx(-float(mode.at(0)[1][2].real), rel=4e-15)
    largest = max(abs(mode.at(0)[1]))
    for depth in depths:
        stress, displacement = mode.at(depth)
        assert error(coating.stress(0.6, 0.8, depth), stress, depth) < ROUNDING
        # Next to a stiff base all components vanish.
        found = max(abs(coating.displacement(0.6, 0.8, depth) - displacement))
        assert found < ROUNDING * (1 + depth) * max(*abs(displacement), largest * mp.exp(-depth))
    for top in ([1, 0, 0], [0, 1, 0]):
        mode = LayeredMode(1, 0, coating, top)
        for depth in depths:
            n, m, x, p, q = (float(kernel) for kernel in coating.shear_kernels(1.0, depth))
            own = nu_base if depth > height else nu
            stress = [1j * m, 1j * own * (m + n), 1j * n, 0, x, 0] if top[0] else [0, 0, 0, p, 0, 1j * q]
            assert error(np.array(stress), mode.at(depth)[0], depth) < ROUNDING


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
    q, depth = np.geomspace(1e-2, 1e2, 40)[:, None], np.linspace(0, 0.7, 8)
    own, half_space = asp.Solid(2.0, 0.3, 0.7), asp.Solid(2.0, 0.3)
    alike = asp.Solid(2.0, 0.3, 0.7, base=half_space)
    rigid = asp.Solid(2.0, 0.3, 0.7, base=asp.Solid(1e20, 0.2))
    for found, expected, depths in ((alike, half_space, 3 * depth), (rigid, own, depth)):
        for ours, theirs in zip(found.kernels(q, depths), expected.kernels(q, depths), strict=True):
            np.testing.assert_allclose(ours, theirs, atol=4e-15)
        for ours, theirs in zip(
            found.shear_kernels(q, depths), expected.shear_kernels(q, depths), strict=True
        ):
            np.testing.assert_allclose(ours, theirs, atol=4e-15)
    plate = asp.Solid(2.0, 0.3, 0.7, "free")
    loose = asp.Solid(2.0, 0.3, 0.7, base=asp.Solid(1e-30, 0.3))
    np.testing.assert_allclose(loose.surface_compliance(q), plate.surface_compliance(q), rtol=4e-15)


@pytest.fixture(scope="module")
def contact():
    """A rough contact of a body with a stiff coating as thin as its patches."""
    height = asp.self_affine((128, 128), 0.8, 0.25, 0.25 / 8, rms_height=1e-3, seed=1)
    return asp.solve_contact(height, asp.Solid(4.0, 0.2, 0.02, base=BASE), contact_area_fraction=0.1)


@pytest.mark.parametrize("lateral", ["confined", "free"])
@pytest.mark.parametrize("friction", [0.0, 0.4])
def test_stress_and_strain_on_the_interface(contact, lateral, friction):
    """Tractions and the strains in the interface are continuous, the other stresses jump."""
    layer = asp.Solid(4.0, 0.2, 0.02, base=BASE, lateral=lateral)
    solid = asp.LoadedSolid(contact.pressure, contact.grid, layer)
    faces = [layer.interface, np.nextafter(layer.interface, 1)]
    names = ("xx", "yy", "zz", "yz", "xz", "xy")
    upper, lower = asp.stress_planes(solid, faces, fields=names, tolerance=0, friction=friction)
    scale, strains = abs(lower.fields["zz"]).max(), []
    for material, plane in ((layer, upper), (BASE, lower)):
        xx, yy, zz, _, _, xy = (plane.fields[name] for name in names)
        nu, young = material.poisson, material.young
        strains.append(np.stack([xx - nu * (yy + zz), yy - nu * (xx + zz), (1 + nu) * xy]) / young)
    assert abs(strains[0] - strains[1]).max() < 1e-12 * scale
    for name in ("zz", "yz", "xz"):
        assert abs(upper.fields[name] - lower.fields[name]).max() < 1e-12 * scale
    assert abs(upper.fields["xx"] - lower.fields["xx"]).max() > 0.5 * scale


def test_analysis_finds_peaks_on_both_sides(contact):
    stress, interface = asp.analyse_stress(contact), contact.layer.interface
    depths = stress["plane_depth"].values
    at = int(np.flatnonzero(depths == interface)[0])
    assert depths[at + 1] == np.nextafter(interface, 1)
    largest = stress["maximum_von_mises"].values[0]
    assert largest[at] > 1.2 * largest[at + 1]
    found = asp.stress.select_peaks(stress, "von_mises")["peak_depth"].values
    assert np.sum(found == depths[at]) > 5
    assert np.sum(found == depths[at + 1]) > 5
    section = asp.stress_section(contact, fields=("xx",))
    assert {interface, depths[at + 1]} <= set(section["depth"].values)


@pytest.mark.parametrize(("contrast", "height"), [(50.0, 0.1), (4.0, 0.02), (0.02, 0.01)])
def test_error_of_coarser_planes_is_below_its_bound(contact, contrast, height):
    """The bound of the truncation in both materials, and with it the tolerance."""
    solid = asp.LoadedSolid(contact.pressure, contact.grid, asp.Solid(contrast, 0.3, height, base=BASE))
    depths = [depth for depth in asp.stress.depth_grid(contact.grid, interface=height) if 0.02 < depth < 0.5]
    names = ("xx", "zz", "xz", "von_mises", "principal_1")
    planes, exact = (
        asp.stress_planes(solid, depths, fields=names, tolerance=tolerance, friction=0.3)
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
    assert coarse > 4


@pytest.mark.parametrize("contrast", [1e-6, 1e-3, 30.0, 1e3, 1e6])
@pytest.mark.parametrize("thickness", [1e-3, 0.01, 0.1, 1.0])
@pytest.mark.parametrize(("nu", "area"), [(0.2, 0.02), (0.5, 0.45)])
def test_pressure_of_any_coating_is_direct(contrast, thickness, nu, area):
    """Solver error, ten tolerances of 1e-6, of a contact on 24² nodes."""
    height = asp.self_affine((24, 24), 0.8, 0.5, 0.125, rms_height=1e-3, seed=10)
    solid = asp.Solid(contrast, nu, thickness, base=asp.Solid(1.0, 0.49))
    contact = asp.solve_contact(height, solid, 1.0, contact_area_fraction=area)
    exact = pivot(height, mode_compliance(solid, contact.grid), mean_pressure=contact.mean_pressure)
    assert np.linalg.norm(contact.pressure - exact) < 1e-5 * np.linalg.norm(exact)


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


def test_coating_of_equal_material_is_half_space():
    height = asp.self_affine((128, 128), 0.8, 0.25, 0.25 / 8, rms_height=1e-3, seed=1)
    plain = asp.solve_contact(height, BASE, mean_pressure=2e-3)
    alike = asp.solve_contact(height, asp.Solid(1.0, 0.3, 0.02, base=BASE), mean_pressure=2e-3)
    # The tolerance of both solutions.
    assert abs(alike.pressure - plain.pressure).max() < 1e-5 * plain.maximum_pressure
    # Waves shorter than a coating see it alone, those longer its base.
    thick = asp.solve_contact(height, asp.Solid(1.0, 0.3, 1e3, base=asp.Solid(9.0, 0.1)), mean_pressure=2e-3)
    thin = asp.solve_contact(height, asp.Solid(9.0, 0.1, 1e-9, base=BASE), mean_pressure=2e-3)
    assert abs(thick.pressure - plain.pressure).max() < 1e-5 * plain.maximum_pressure
    assert abs(thin.pressure - plain.pressure).max() < 1e-4 * plain.maximum_pressure


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

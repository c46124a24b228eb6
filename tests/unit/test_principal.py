"""Principal stresses in closed form against numpy's iterative eigenvalues."""

import numpy as np
import pytest

from asperity.elasticity.layer import COMPONENTS, Layer
from asperity.elasticity.loaded_solid import LoadedSolid
from asperity.fourier.grid import Grid
from asperity.reference.elementary import largest_shear, von_mises
from asperity.stress.planes.fields import FIELDS, principal_stresses
from asperity.stress.planes.planes import stress_planes

ROUNDING = 4e-15


def pressed(seed=1, spots=12):
    """Sharp random spots on a half-space."""
    grid = Grid((64, 64))
    y, x = grid.coordinates()
    draw = np.random.default_rng(seed)
    pressure = np.zeros(grid.shape)
    for cy, cx, radius in zip(
        *draw.uniform(0.1, 0.9, (2, spots)), draw.uniform(0.02, 0.08, spots), strict=True
    ):
        square = (y[:, None] - cy) ** 2 + (x[None, :] - cx) ** 2
        pressure += 0.1 * np.sqrt(np.maximum(1 - square / radius**2, 0))
    return LoadedSolid(pressure, grid, Layer(young=1.0, poisson=0.3))


def assert_eigenvalues(tensor):
    xx, yy, zz, yz, xz, xy = tensor[[0, 1, 2, 1, 0, 0], [0, 1, 2, 2, 2, 1]]
    found = principal_stresses(xx, yy, zz, yz, xz, xy)
    expected = np.linalg.eigvalsh(tensor)[::-1]
    assert found[0] >= found[1] >= found[2]
    np.testing.assert_allclose(found, expected, rtol=0, atol=ROUNDING * np.abs(tensor).max())


@pytest.mark.parametrize(
    "principal",
    [
        lambda draw: draw.normal(size=3),
        lambda draw: np.repeat(draw.normal(size=2), [2, 1]),
        lambda draw: draw.normal() + 10 ** draw.uniform(-16, -1) * draw.normal(size=3),
        lambda draw: np.array([1.0, 1 + 10 ** draw.uniform(-16, -4), draw.normal()]),
        lambda draw: 10 ** draw.uniform(-20, 0, 3) * draw.choice([-1, 1], 3),
        lambda draw: np.array([draw.normal(), 0.0, 0.0]),
    ],
    ids=["any", "double", "nearly triple", "nearly double", "scales", "uniaxial"],
)
def test_principal_stresses_of_rotated_tensors_of_any_size(principal):
    draw = np.random.default_rng(3)
    for _ in range(500):
        rotation = np.linalg.qr(draw.normal(size=(3, 3)))[0]
        tensor = rotation @ np.diag(principal(draw)) @ rotation.T * 10 ** draw.uniform(-60, 60)
        assert_eigenvalues((tensor + tensor.T) / 2)


def test_principal_stresses_where_rounding_is_all_of_the_deviator():
    draw = np.random.default_rng(4)
    for _ in range(500):
        noise = draw.integers(-3, 4, (3, 3)) * np.finfo(float).eps
        assert_eigenvalues(np.eye(3) + np.tril(noise) + np.tril(noise, -1).T)


def test_principal_stresses_of_all_tensors_with_elements_of_minus_one_to_one():
    for elements in np.ndindex(3, 3, 3, 3, 3, 3):
        a, b, c, f, g, h = np.array(elements, float) - 1
        assert_eigenvalues(np.array([[a, h, g], [h, b, f], [g, f, c]]))


def test_fields_of_the_planes_are_those_of_their_components():
    for ratios in ([0.1, 0.45], [0.3]):
        for plane in stress_planes(pressed(), [0.0, 0.03], ratios, FIELDS):
            xx, yy, zz, yz, xz, xy = (plane.fields[name] for name in COMPONENTS)
            tensor = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(*xx.shape, 3, 3)
            principal = np.linalg.eigvalsh(tensor)
            for number, name in enumerate(("principal_3", "principal_2", "principal_1")):
                np.testing.assert_allclose(plane.fields[name], principal[..., number], atol=1e-14)
            stress = np.stack([xx, yy, zz, yz, xz, xy], axis=-1)
            np.testing.assert_allclose(plane.fields["largest_shear"], largest_shear(stress), atol=1e-14)
            np.testing.assert_allclose(plane.fields["von_mises"], von_mises(stress), atol=1e-14)
            mean = (xx + yy + zz) / 3
            np.testing.assert_allclose(plane.fields["hydrostatic"], mean, atol=1e-14)
            alone = next(stress_planes(pressed(), [plane.depth], ratios, ("hydrostatic",)))
            np.testing.assert_allclose(alone.fields["hydrostatic"], mean, atol=1e-14)

"""Principal stresses in closed form against numpy's iterative eigenvalues."""

import numpy as np
import pytest
from samples import invariants, spots

import asperity as asp
from asperity.elasticity.solid import COMPONENTS
from asperity.stress.planes.fields import FIELDS, principal_stresses

ROUNDING = 4e-15


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
def test_rotated_tensors_of_any_size(principal):
    draw = np.random.default_rng(3)
    for _ in range(300):
        rotation = np.linalg.qr(draw.normal(size=(3, 3)))[0]
        tensor = rotation @ np.diag(principal(draw)) @ rotation.T * 10 ** draw.uniform(-60, 60)
        assert_eigenvalues((tensor + tensor.T) / 2)


def test_deviators_that_are_all_rounding():
    draw = np.random.default_rng(4)
    for _ in range(300):
        noise = draw.integers(-3, 4, (3, 3)) * np.finfo(float).eps
        assert_eigenvalues(np.eye(3) + np.tril(noise) + np.tril(noise, -1).T)


def test_all_tensors_of_minus_one_to_one():
    for elements in np.ndindex(3, 3, 3, 3, 3, 3):
        a, b, c, f, g, h = np.array(elements, float) - 1
        assert_eigenvalues(np.array([[a, h, g], [h, b, f], [g, f, c]]))


@pytest.mark.parametrize("ratios", [[0.1, 0.45], [0.3]])
def test_fields_of_planes_are_those_of_their_components(ratios):
    for plane in asp.stress_planes(spots(), [0.0, 0.03], ratios, FIELDS):
        expected = invariants(np.stack([plane.fields[name] for name in COMPONENTS], axis=-1))
        for name, values in expected.items():
            np.testing.assert_allclose(plane.fields[name], values, atol=1e-14, err_msg=name)
        alone = next(asp.stress_planes(spots(), [plane.depth], ratios, ("hydrostatic",)))
        np.testing.assert_allclose(alone.fields["hydrostatic"], expected["hydrostatic"], atol=1e-14)

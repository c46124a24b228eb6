"""The layer against the independent high-precision solution, over its whole range."""

import mpmath as mp
import numpy as np
import pytest
from rounding import FORMULAS, PRECISIONS, element_errors, rounding_errors

from asperity.elasticity.solid import Solid
from asperity.reference.state_space import StateSpace

# Bounds of rounding errors, relative to the largest component at the same depth and to 1 + q depth.
ROUNDING = {"float64": 4e-15, "float32": 2e-6}

HEIGHTS = [1e-8, 0.02, 0.999, 1.001, 39.0, 1e5]
RATIOS = [-0.99, 0.33, 0.4999999, 0.5]

DEEPEST = {"float32": 70.0, "float64": 600.0}
"""Limits on q · depth: deeper, e^(−q depth) leaves the normal range of the precision."""


def layer_errors(height, bottom, poisson, dtype, fractions=(0.0, 1e-7, 1e-3, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0)):
    """Largest rounding errors of one mode with q ≈ 1, against 80 digits; the half-space to a depth of 20.

    Of the surface compliance, relative; of the stress, relative to its largest component at the same depth
    and divided by 1 + q depth; of the displacement likewise, but relative to e^(−q depth) of its largest
    component at the top where that is larger, because next to a support all components may vanish together.
    For a free bottom, of the surface compliance alone.
    """
    kind = np.dtype(dtype)
    qx, qy = (np.full(1, component, kind) for component in (0.6, 0.8))
    if height is not None:
        height = float(np.array(height, kind))
    layer = Solid(1.3, poisson, height, bottom)
    mode = StateSpace(float(qx[0]), float(qy[0]), layer.young, poisson, height, bottom)
    # The compliance takes the wavenumber, rounded to the precision, instead of its components.
    rounded = np.array([float(mode.q)], kind)
    along_x = StateSpace(float(rounded[0]), 0, layer.young, poisson, height, bottom)
    exact = -along_x.displacement(0)[2].real
    errors = [float(abs(layer.surface_compliance(rounded)[0].item() / exact - 1))]
    if bottom == "free" and height is not None:
        return errors
    top = max(abs(mode.displacement(0)))
    for fraction in fractions:
        depth = np.array([fraction * (height or 20.0)], kind)
        decay = float(mode.q) * float(depth[0])
        if decay > DEEPEST[kind.name]:
            continue
        for values, true, least in (
            (layer.stress(qx, qy, depth)[0], mode.stress(float(depth[0])), 0),
            (layer.displacement(qx, qy, depth)[0], mode.displacement(float(depth[0])), top * mp.exp(-decay)),
        ):
            largest, size = max(abs(values.astype(complex) - true)), max(least, *abs(true))
            errors.append(float(largest / size) / (1 + decay))
    return errors


@pytest.mark.parametrize(("poisson", "dtype"), [*((nu, "float64") for nu in RATIOS), (0.33, "float32")])
@pytest.mark.parametrize("bottom", ["bonded", "frictionless", "free"])
def test_layer_is_exact_to_rounding(bottom, poisson, dtype):
    for height in HEIGHTS:
        errors = layer_errors(height, bottom, poisson, dtype, fractions=(0.0, 1e-4, 0.3, 0.9999, 1.0))
        assert max(errors) < ROUNDING[dtype], (height, errors)


@pytest.mark.parametrize("dtype", PRECISIONS)
@pytest.mark.parametrize("poisson", RATIOS)
def test_half_space_is_exact_to_rounding(poisson, dtype):
    errors = layer_errors(None, "bonded", poisson, dtype)
    assert max(errors) < ROUNDING[dtype], errors


def test_green_tensor_is_exact_to_rounding():
    """Every element over √(G_ii G_jj); largest in ``studies/stability/README.md``: 8.2e-16."""
    errors = element_errors(poisson=(-0.999999, 0.33, 0.5), per_decade=1)
    assert errors.shape == (6, 6)
    assert 1e-17 < errors.max() < 8e-15


def test_rounding_errors_tell_the_formulas_apart():
    data = rounding_errors(poisson=(0.33, 0.5), smallest=1e-4, largest=1e3, per_decade=1)
    error = data["error"]
    assert error.shape == (2, len(FORMULAS), len(PRECISIONS), 2, 8)
    for precision in PRECISIONS:
        ours = error.sel(formula="layer", precision=precision)
        assert float(ours.max(skipna=False)) < ROUNDING[precision]
    theirs = error.sel(formula="printed", quantity="compliance", precision="float64", poisson=0.33)
    assert float(theirs.min()) < 1e-12
    assert float(theirs.max()) > 1e-6 or bool(np.isnan(theirs).any())

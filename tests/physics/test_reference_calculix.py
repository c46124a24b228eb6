"""CalculiX: its input deck and, where the program is installed, its results."""

import re

import numpy as np
import pytest

from asperity.reference import calculix
from asperity.reference.finite_element import Slab, press
from asperity.reference.line_elements import graded

PLANE, COLUMN = graded(0.5, 4, 2.0), 1 - graded(1.0, 4, 4.0)[::-1]
MODEL = {"young": 1 - 0.33**2, "poisson": 0.33, "curvature_radius": 10.0, "approach": 0.002}


def test_deck_has_every_node_its_elements_need():
    deck = calculix.write_deck(PLANE, COLUMN, **MODEL, penalty=1e4)
    blocks = re.split(r"\n\*", deck)
    nodes = {
        int(line.split(",")[0])
        for block in blocks
        if re.match(r"\*?NODE, NSET", block)
        for line in block.splitlines()[1:]
    }
    used = set()
    for block in blocks:
        if block.startswith("ELEMENT"):
            numbers = [int(entry) for entry in re.findall(r"\d+", "\n".join(block.splitlines()[1:]))]
            elements = np.array(numbers).reshape(-1, 21)
            used |= set(elements[:, 1:].ravel().tolist())
    assert used == nodes


def test_shape_functions_are_one_at_their_node_and_sum_to_one():
    for number, place in enumerate(calculix._BRICK):
        shape = calculix._serendipity(*(np.array(place) - 1.0))
        np.testing.assert_array_equal(shape, np.eye(20)[number])
    assert calculix._serendipity(0.3, -0.7, 0.1).sum() == pytest.approx(1, rel=1e-14)


def test_missing_program_says_how_to_install(monkeypatch, tmp_path):
    monkeypatch.setattr(calculix, "PROGRAM", "no-such-program")
    assert not calculix.available()
    with pytest.raises(FileNotFoundError, match="apt install calculix-ccx"):
        calculix.press(tmp_path, PLANE, COLUMN, **MODEL, penalty=1e4)


@pytest.mark.skipif(not calculix.available(), reason="CalculiX is optional and not installed")
def test_two_codes_agree_on_a_coarse_mesh(tmp_path):
    theirs = calculix.press(tmp_path, PLANE, COLUMN, **MODEL, penalty=2e3)
    slab = Slab(PLANE, COLUMN, MODEL["young"], MODEL["poisson"])
    ours = press(slab, MODEL["curvature_radius"], MODEL["approach"])
    x, z, moved, _ = slab.on_diagonal(ours.displacement)
    np.testing.assert_allclose(theirs.x, x)
    np.testing.assert_allclose(theirs.z, z)
    # Mesh: four elements an edge, and other elements and contact.
    assert theirs.load == pytest.approx(ours.load, rel=0.03)
    assert np.abs(theirs.displacement - moved)[..., 2].max() < 0.03 * np.abs(moved).max()

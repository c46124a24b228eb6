"""Surfaces, loaded solids, maps, commands, measures and refused arguments that many tests share."""

from dataclasses import replace

import numpy as np
import pytest

import asperity as asp
from asperity.cli.main import main

HALF_SPACE, LAYER = asp.Solid(1.0, 0.3), asp.Solid(1.0, 0.3, height=0.2)
PAIR = asp.TwoBodies(HALF_SPACE, asp.Solid(0.1, 0.4, height=0.02))

every_solid = pytest.mark.parametrize(
    ("solid", "boundary"),
    [(HALF_SPACE, "periodic"), (HALF_SPACE, "free"), (LAYER, "periodic"), (PAIR, "periodic")],
)


def rough(shape=(64, 64), seed=1):
    """A surface with eight nodes or more in its shortest wave."""
    return asp.self_affine(shape, 0.8, 0.5, 8 / min(shape), 1e-3, seed)


def load_of(height, fraction=0.05):
    """Mean pressure that is a fraction of the rms gradient, on a solid with E* near 1."""
    return fraction * asp.roughness_parameters(height).rms_gradient


def hardened(height, share, solid=HALF_SPACE, **settings):
    """A contact whose hardness is a share of its largest pressure without one."""
    settings = {"mean_pressure": load_of(height)} | settings
    largest = asp.solve_contact(height, solid, **settings).maximum_pressure
    return asp.solve_contact(height, solid, hardness=share * largest, **settings)


def with_gap(gap, boundary="periodic", length=1.0):
    """A contact with a gap that is given, closed where it is 0."""
    contact = asp.solve_contact(rough((32, 32)), HALF_SPACE, mean_pressure=1e-3)
    grid, pressure = asp.Grid(gap.shape, length), np.where(gap > 0, 0.0, 1.0)
    return replace(contact, gap=gap, pressure=pressure, grid=grid, boundary=boundary)


def centred(grid):
    """Positions y, (ny, 1), and x, (nx,), from the middle of the nodes."""
    y, x = (axis - axis.mean() for axis in grid.coordinates())
    return y[:, None], x


def spots(shape=(64, 64), length=1.0, layer=HALF_SPACE, boundary="periodic", seed=1):
    """A solid under sharp random spots: any pressure that is not negative is a possible one."""
    grid = asp.Grid(shape, length)
    y, x = (axis / edge for axis, edge in zip(grid.coordinates(), grid.length, strict=True))
    draw = np.random.default_rng(seed)
    pressure = np.zeros(shape)
    for cy, cx, radius in zip(*draw.random((2, 12)), draw.uniform(0.02, 0.1, 12), strict=True):
        dy, dx = ((place - centre + 0.5) % 1 - 0.5 for place, centre in ((y, cy), (x, cx)))
        pressure += np.sqrt(np.maximum(1 - (dy[:, None] ** 2 + dx**2) / radius**2, 0))
    return asp.LoadedSolid(0.1 * pressure, grid, layer, boundary)


def invariants(stress):
    """Fields of a stress (..., 6), from the eigenvalues of its tensor by numpy."""
    xx, yy, zz, yz, xz, xy = np.moveaxis(stress, -1, 0)
    tensor = np.stack([xx, xy, xz, xy, yy, yz, xz, yz, zz], axis=-1).reshape(*xx.shape, 3, 3)
    third, second, first = np.moveaxis(np.linalg.eigvalsh(tensor), -1, 0)
    squares = (first - second) ** 2 + (second - third) ** 2 + (third - first) ** 2
    fields = {"principal_1": first, "principal_2": second, "principal_3": third}
    fields |= {"maximum_shear": (first - third) / 2, "von_mises": np.sqrt(squares / 2)}
    return fields | {"hydrostatic": (xx + yy + zz) / 3}


def order(points, errors):
    """Order of convergence: minus the exponent of the number of points in the error."""
    return -np.polyfit(np.log(points), np.log(errors), 1)[0]


def difference(found, exact):
    """Norm of the difference of two fields over the norm of the second."""
    return np.linalg.norm(found - exact) / np.linalg.norm(exact)


def write_map(path, height, edges):
    """Write heights in µm as text, with the edges y, x of their map in µm; its name."""
    head = "# Channel: Height\n# Width: {1:g} um\n# Height: {0:g} um\n# Value units: um".format(*edges)
    np.savetxt(path, height, header=head, comments="", fmt="%.6f")
    return str(path)


def leave_pictures_out(patch):
    """Answers, samples and comparisons are written without pictures."""
    for name in ("pictures", "compared_pictures"):
        patch.setattr(f"asperity.engineering.show.pictures.{name}", lambda _: [])


def status(*words):
    """Exit status of a command."""
    try:
        return main([*map(str, words)])
    except SystemExit as ended:
        return ended.code


def refuses(*rows):
    """A test that calls are refused with messages that begin as given, from pairs of call and message."""

    @pytest.mark.parametrize(("call", "message"), rows)
    def test(call, message):
        with pytest.raises((ValueError, TypeError), match=f"^{message}") as caught:
            call()
        statement = str(caught.traceback[-1].statement).lstrip()
        assert statement.startswith("raise"), "an exception of Python's or NumPy's own"
        assert all(line.isprintable() and len(line) < 300 for line in str(caught.value).splitlines())

    return test

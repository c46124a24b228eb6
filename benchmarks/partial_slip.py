"""Error of the superposition of partial slip, against dense solutions of Coulomb's law on rough surfaces.

    python benchmarks/partial_slip.py --points 32 --seeds 3

prints a table of errors, in a minute on one core. The traction q of a first loading minimises ½ q·C q − Δ
e·q, with the tangential compliance C of the contact nodes and the displacement Δ e: over |q| ≤ μ p along the
force alone, or over |q| ≤ μ p of both components. C is Cerruti's for a traction that is uniform on the square
of a node, or in a periodic cell 2 (1 − ν²)/q for waves along the traction and 2 (1 + ν)/q for waves across
it.
"""

import numpy as np
from measuring import parser_of

import asperity as asp

FRICTION = 0.4
SHARES = (0.2, 0.5, 0.9)
"""Tangential force over its limit μ P."""

MAX_STEPS, TOLERANCE = 20000, 1e-9


def cerruti(y, x, step, poisson):
    """Displacements per unit traction along x on a square at the origin, along it and across, E = 1."""
    along = across = 0.0
    for sign_y in (-1, 1):
        for sign_x in (-1, 1):
            dy, dx = y + sign_y * step / 2, x + sign_x * step / 2
            distance, sign = np.hypot(dy, dx), sign_y * sign_x
            own = dy * np.log(dx + distance)
            along = along + sign * (own + (1 - poisson) * dx * np.log(dy + distance))
            across = across - sign * poisson * distance
    return (1 + poisson) / np.pi * along, (1 + poisson) / np.pi * across


def periodic(points, poisson):
    """Displacements of all nodes per unit traction along x on the first one, along it and across, E = 1."""
    grid = asp.Grid((points, points))
    q = grid.wavenumber()
    square = np.where(q > 0, q, np.inf) ** 2
    q[0, 0] = np.inf
    stiffer = 2 * (1 - poisson**2) - 2 * (1 + poisson)
    along = (2 * (1 + poisson) + stiffer * grid.qx**2 / square) / q
    across = stiffer * grid.odd_qy[:, None] * grid.odd_qx / square / q
    return (np.fft.irfft2(part, grid.shape) for part in (along, across))


def compliance(contact, poisson):
    """Dense compliance of the contact nodes, [x and y, nodes, x and y, nodes], of the same traction."""
    points = contact.grid.shape[0]
    row, column = np.nonzero(contact.pressure)
    dy, dx = row[:, None] - row, column[:, None] - column
    if contact.boundary == "free":
        xx, xy = cerruti(dy / points, dx / points, 1 / points, poisson)
        yy, _ = cerruti(dx / points, dy / points, 1 / points, poisson)
    else:
        alike, turned = periodic(points, poisson)
        xx, xy, yy = alike[dy, dx], turned[dy, dx], alike.T[dy, dx]
    return np.block([[xx, xy], [xy, yy]])


def coulomb(matrix, limit, displacement):
    """Traction of all components, by accelerated projected gradients (Beck & Teboulle 2009) with restarts."""
    pull = np.zeros(len(matrix))
    pull[: limit.size] = displacement
    step = 1 / np.linalg.eigvalsh(matrix)[-1]
    found, ahead, momentum = np.zeros_like(pull), np.zeros_like(pull), 1.0
    for _ in range(MAX_STEPS):
        parts = (ahead - step * (matrix @ ahead - pull)).reshape(-1, limit.size)
        size = np.sqrt(np.sum(parts**2, axis=0))
        new = (parts * np.minimum(1, limit / np.maximum(size, 1e-300))).ravel()
        if (ahead - new) @ (new - found) > 0:
            momentum = 1.0
        change, grown = new - found, 0.5 + np.sqrt(0.25 + momentum**2)
        ahead, found, momentum = new + (momentum - 1) / grown * change, new, grown
        if np.linalg.norm(change) <= TOLERANCE * np.linalg.norm(new):
            return found.reshape(-1, limit.size)
    raise RuntimeError("the projected gradients do not converge")


def errors(contact, share, matrix):
    """`deviation`; errors of traction, force and sticking part; traction and force of both components."""
    slip = asp.contact.partial_slip(contact, FRICTION, tangential_force=share * FRICTION * contact.force)
    touching = contact.pressure > 0
    limit, ours = FRICTION * contact.pressure[touching], slip.traction[touching]
    found = [slip.deviation]
    for size in (limit.size, 2 * limit.size):
        exact = coulomb(matrix[:size, :size], limit, slip.displacement)
        difference = exact.copy()
        difference[0] -= ours
        found += [np.linalg.norm(difference) / np.linalg.norm(exact), abs(ours.sum() / exact[0].sum() - 1)]
        if len(exact) == 1:
            found.append(abs(slip.sticking_area - np.mean(exact[0] < (1 - 1e-6) * limit)))
    return found


def main():
    parser = parser_of(__doc__)
    parser.add_argument("--points", type=int, default=32)
    parser.add_argument("--seeds", type=int, default=3)
    options = parser.parse_args()
    shape = options.points, options.points
    for boundary in ("free", "periodic"):
        for area in (0.05, 0.15, 0.26, 0.5):
            for poisson in (0.0, 0.3, 0.5):
                found = []
                for seed in range(1, options.seeds + 1):
                    height = asp.self_affine(shape, 0.8, 0.5, 8 / options.points, 1e-3, seed)
                    solid = asp.Solid(1.0, poisson)
                    contact = asp.solve_contact(
                        height, solid, contact_area_fraction=area, boundary=boundary, rtol=1e-9
                    )
                    matrix = compliance(contact, poisson)
                    found += [errors(contact, share, matrix) for share in SHARES]
                ends = zip(100 * np.min(found, axis=0), 100 * np.max(found, axis=0), strict=True)
                cells = " | ".join(f"{low:.1f} to {high:.1f} %" for low, high in ends)
                print(f"| {boundary} | {100 * area:.0f} % | {poisson} | {cells} |", flush=True)


if __name__ == "__main__":
    main()

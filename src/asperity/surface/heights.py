"""Surfaces with a given spectrum and a given distribution of their heights, both.

A transform of the heights alone, such as Johnson's, changes the spectrum and the gradient too. Here the
heights are replaced rank by rank by those of the distribution, and the amplitudes of all waves by those of
the spectrum, in turns, until the two no longer approach each other. The last step is that of the spectrum:
rms height, rms gradient and the band of wavelengths are exact, and the distribution is reached as far as the
band allows.

References
----------
T. Schreiber and A. Schmitz, Phys. Rev. Lett. 77 (1996) 635, doi 10.1103/PhysRevLett.77.635 (time series).
F. Pérez-Ràfols and A. Almqvist, Tribol. Int. 131 (2019) 591, doi 10.1016/j.triboint.2018.11.020 (surfaces).
ISO 13565-3 (Rpq, Rvq and Rmq of the material probability curve).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.special import ndtri

from asperity.core.arguments import finite_array, magnitude, number, require_finite
from asperity.core.types import Array
from asperity.fourier.grid import Fourier, Grid, good_size, resample
from asperity.surface.johnson import with_moments
from asperity.surface.roughness import varying_heights

NODES_PER_WAVE = 4
"""Nodes on the shortest wave of the grid of the iteration. The mean of the third power of the heights has no
alias on it, that of the fourth one only of waves at the end of the band: moments are those of finer grids."""

IN_BAND = 1e-12
"""Amplitude over the largest one below which a wave is a rounding error."""

MOST_ITERATIONS = 200
SLOWEST = 1e-3
"""Relative fall of the residual in an iteration at which it ends. Up to ten times as many iterations make the
residual smaller by 4 to 30 %."""


class ShapedSurface(NamedTuple):
    """A surface with the spectrum of one surface and nearly the heights of a distribution.

    Parameters
    ----------
    height : (ny, nx) array
    heights_residual : float
        Root-mean-square difference between the sorted heights and those of the distribution, over the rms
        height.
    spectrum_residual : float
        The same of the amplitudes of all waves: a rounding error.
    iterations : int
    """

    height: Array
    heights_residual: float
    spectrum_residual: float
    iterations: int


def with_heights(
    height: ArrayLike,
    *,
    moments: Sequence[float] | None = None,
    plateau: Sequence[float] | None = None,
    sample: ArrayLike | None = None,
) -> ShapedSurface:
    """Surface with the amplitudes of all waves of a surface, and heights of another distribution.

    Exactly one of `moments`, `plateau` and `sample` is given.

    Parameters
    ----------
    height : (ny, nx) array
        Heights of a periodic lower face, such as those of `self_affine`. Waves at the Nyquist wavenumber are
        left out.
    moments : (skewness, kurtosis)
        Of a Johnson curve, as in `with_moments`. Positive skewness makes blunt contacts.
    plateau : (Rpq, Rvq, Rmq)
        Root-mean-square roughness of plateau and valleys, of which only the ratio counts, and the material
        ratio in per cent at which one passes into the other (ISO 13565-3): two Gaussians, the valleys of a
        map being the high parts of the lower face.
    sample : array
        Heights of any shape with that distribution, of a lower face, such as ``treat_map(...).height``. Only
        its form counts.

    Returns
    -------
    ShapedSurface
        Its height has the unit, rms height and rms gradient of the input. It is the same surface for the same
        waves on every grid.

    Raises
    ------
    TypeError, ValueError
        If not exactly one distribution is given, or one or the heights are out of range.

    Examples
    --------
    >>> gaussian = asp.self_affine((256, 256), 0.8, 1 / 4, 1 / 32, rms_height=1e-3, seed=1)
    >>> shaped = asp.with_heights(gaussian, moments=(-1.0, 4.0))
    >>> before, after = (asp.roughness_parameters(h) for h in (gaussian, shaped.height))
    >>> f"{after.skewness:.2f}", abs(after.rms_gradient / before.rms_gradient - 1) < 1e-12
    ('-1.00', True)
    >>> honed = asp.with_heights(gaussian, plateau=(0.1, 0.4, 80))
    >>> shaped.heights_residual < 0.01, honed.heights_residual < 0.01
    (True, True)
    """
    values = varying_heights(height)
    grid = Grid(values.shape)
    modes = Fourier(grid).forward(values)
    modes[0, 0] = 0
    held = np.abs(modes) > IN_BAND * np.abs(modes).max()
    held &= (2 * np.abs(grid.ky[:, None]) < grid.shape[0]) & (2 * grid.kx[None, :] < grid.shape[1])
    rows, columns = np.nonzero(held)
    if not rows.size:
        raise ValueError("height: waves below the Nyquist wavenumber are needed, this surface has none")
    largest = int(np.abs(grid.ky[rows]).max()), int(grid.kx[columns].max())
    own = Grid(
        (good_size(NODES_PER_WAVE * max(largest[0], 1)), good_size(NODES_PER_WAVE * max(largest[1], 1)))
    )
    fourier, modes = Fourier(own), resample(modes, grid, own)
    amplitude = np.abs(modes)
    before = fourier.inverse(modes)
    rms_height = before.std()
    target = _sorted_heights(before.size, moments, plateau, sample)
    target *= rms_height / target.std()

    residuals = [np.inf, 2.0]
    while len(residuals) < MOST_ITERATIONS + 2 and residuals[-1] <= (1 - SLOWEST) * residuals[-2]:
        before.flat[np.argsort(before, axis=None)] = target
        wanted = fourier.forward(before)
        modes = amplitude * np.exp(1j * np.angle(wanted))
        before = fourier.inverse(modes)
        difference = np.sort(before, axis=None) - target
        residuals.append(float(np.sqrt(np.mean(difference**2)) / rms_height))
    found = Fourier(grid).inverse(resample(modes, own, grid))
    require_finite("with_heights", {"height": found})
    reached = np.abs(resample(Fourier(grid).forward(found), grid, own))
    error = np.linalg.norm(reached - amplitude) / np.linalg.norm(amplitude)
    return ShapedSurface(found, residuals[-1], float(error), len(residuals) - 2)


def _sorted_heights(count: int, moments: Any, plateau: Any, sample: Any) -> Array:
    """Rising heights of the distribution with mean zero, each of the same share of the area."""
    given = {"moments": moments, "plateau": plateau, "sample": sample}
    names = [name for name, value in given.items() if value is not None]
    if len(names) != 1:
        raise ValueError(
            f"{', '.join(names) or 'no distribution'}: exactly one of {', '.join(given)} is needed"
        )
    share = (np.arange(count) + 0.5) / count
    if sample is not None:
        found = np.quantile(np.ravel(finite_array("sample", sample)), share, method="hazen")
        if not found.std() > 0:
            raise ValueError(f"sample: heights are needed that differ in more than one of {count} places")
    elif moments is not None:
        skewness, kurtosis = _numbers("moments", moments, ("skewness", "kurtosis"))
        found = with_moments(ndtri(share)[None], skewness, kurtosis)[0]
    else:
        peaks, valleys, ratio = _numbers("plateau", plateau, ("Rpq", "Rvq", "Rmq"))
        magnitude("plateau Rpq", peaks)
        magnitude("plateau Rvq", valleys)
        number("plateau Rmq", ratio, "a number between 0 and 100", lambda percent: 0 < percent < 100)
        # The share of the lower face below a height is the material ratio of the map above it.
        normal, bend = ndtri(share), ndtri(ratio / 100)
        found = np.where(normal < bend, peaks, valleys) * (normal - bend)
    return found - found.mean()


def _numbers(name: str, values: Any, parts: Sequence[str]) -> list[float]:
    if not isinstance(values, Sequence | np.ndarray) or len(values) != len(parts):
        raise ValueError(f"{name} = {values!r}: {len(parts)} numbers ({', '.join(parts)}) are needed")
    return list(values)

"""Covariance of the planes of a stream with the plane of the largest von Mises stress (Eq. 22)."""

from __future__ import annotations

import numpy as np

from asperity.spectral import Fourier, Grid, Work, resample
from asperity.stress.kernels import moments
from asperity.types import Array


class ReferencePlane:
    """The plane with the largest value so far, and the covariance of all planes with it.

    The planes come one by one, each on a grid no finer than the one before. Those above the reference are
    known only when the stream has ended, and are to be added again with `compare`.

    Parameters
    ----------
    planes : int
        Number of planes of the stream.
    threads : int
    work : Work
        Where transforms are counted.

    Attributes
    ----------
    number : int
        Which plane of the stream is the reference.
    covariance : (planes,) array
        Mean of the product of the fields of each plane and of the reference, less the product of their means;
        NaN where a plane has not been compared.
    """

    def __init__(self, planes: int, threads: int, work: Work) -> None:
        self.number = -1
        self.covariance = np.full(planes, np.nan)
        self._largest = -np.inf
        self._own: tuple[Grid, Array] | None = None
        self._modes: tuple[Grid, Array] | None = None
        self._resampled: tuple[Grid, Array] | None = None
        self._threads, self._work = threads, work

    @property
    def grid(self) -> Grid:
        """Grid of the reference."""
        assert self._own is not None
        return self._own[0]

    @property
    def field(self) -> Array:
        """Field of the reference on its own grid."""
        assert self._own is not None
        return self._own[1]

    def add(self, number: int, grid: Grid, field: Array, largest: float) -> float:
        """Compare the next plane downward; it becomes the reference if its largest value is the largest.

        Returns
        -------
        mean : float
            Of the field.
        """
        if largest > self._largest:
            self.number, self._largest, self._own = number, largest, (grid, field)
            self._modes = self._resampled = None
        return self.compare(number, grid, field)

    def compare(self, number: int, grid: Grid, field: Array) -> float:
        """Store the covariance of a plane with the reference; returns the mean of the field."""
        resampled = self._resampled
        own = self.field if resampled is None or resampled[0] != grid else resampled[1]
        mean_own, mean, product = moments(own, field)
        self.covariance[number] = product - mean_own * mean
        return mean

    def resample_to(self, grid: Grid) -> None:
        """Make the reference ready for planes on another grid."""
        if self._own is None or grid == self.grid:
            self._resampled = None
        elif self._resampled is None or self._resampled[0] != grid:
            if self._modes is None or np.any(np.array(grid.shape) > self._modes[0].shape):
                fourier = Fourier(self.grid, threads=self._threads, work=self._work)
                self._modes = self.grid, fourier.forward(self.field)
            # Grids become coarser: modes that this one does not hold are not needed again.
            self._modes = grid, resample(self._modes[1], self._modes[0], grid)
            fourier = Fourier(grid, threads=self._threads, work=self._work)
            self._resampled = grid, fourier.inverse(self._modes[1])

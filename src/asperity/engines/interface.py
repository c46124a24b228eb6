"""The interface of an engine: transforms of two-dimensional real fields."""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from asperity.types import Array


class Engine(ABC):
    """Transforms of real fields, with the normalisation of `asperity.spectral`.

    Of a field of ny rows, only the first ones may be given or asked for: the others are taken to be zero, or
    left out. The result does not depend on the number of threads; an engine may be used by several threads
    at once. Arrays may be views, with rows at any distance.
    """

    @property
    @abstractmethod
    def description(self) -> str:
        """Library, version and plans, as recorded in results."""

    @abstractmethod
    def forward(self, values: Array, out: Array, threads: int = 1) -> None:
        """Coefficients of a field.

        Parameters
        ----------
        values : (rows, nx) array
            The first rows of the field.
        out : (ny, nx // 2 + 1) complex array of the same precision
            Array for the coefficients.
        threads : int
        """

    @abstractmethod
    def inverse(self, coefficients: Array, out: Array, work: Array, threads: int = 1) -> None:
        """Field of its coefficients.

        Parameters
        ----------
        coefficients : (ny, nx // 2 + 1) complex array
        out : (rows, nx) array of the same precision
            Array for the first rows of the field.
        work : array like `coefficients`
            Array that is overwritten; it may be `coefficients`.
        threads : int
        """

    @abstractmethod
    def inverse_columns(self, coefficients: Array, out: Array, nx: int) -> None:
        """First half of `inverse` for some columns of several fields, by the calling thread.

        Parameters
        ----------
        coefficients : (arrays, ny, columns) complex array
        out : array of the same shape
            Array for the result; it may be `coefficients`.
        nx : int
            Nodes of the fields on a row.
        """

    @abstractmethod
    def inverse_rows(self, coefficients: Array, out: Array, ny: int) -> None:
        """Second half of `inverse` for some rows of several fields, by the calling thread.

        Parameters
        ----------
        coefficients : (arrays, rows, nx // 2 + 1) complex array
            From `inverse_columns`; it may be overwritten.
        out : (arrays, rows, nx) array
            Array for the result. Its rows may begin where those of `coefficients` do, in the same memory.
        ny : int
            Nodes of the fields on a column.
        """

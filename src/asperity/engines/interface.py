"""The interface of an engine: transforms of the lines of two-dimensional arrays."""

from __future__ import annotations

from abc import ABC, abstractmethod

from asperity.types import Array


class Engine(ABC):
    """Transforms of the rows and of the columns of arrays in single and double precision.

    A forward transform of n values is divided by n, an inverse one is not. The result does not depend on the
    number of threads, and an engine may be used by several threads at once. Arrays may be views, with rows at
    any distance.
    """

    @property
    @abstractmethod
    def description(self) -> str:
        """Library, version and plans, as recorded in results."""

    @abstractmethod
    def rows_forward(self, values: Array, out: Array, threads: int = 1) -> None:
        """Coefficients, (rows, n // 2 + 1), of real rows, (rows, n)."""

    @abstractmethod
    def rows_inverse(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        """Real rows, (rows, n), of their coefficients, (rows, n // 2 + 1), which may be overwritten."""

    @abstractmethod
    def columns_forward(self, values: Array, out: Array, threads: int = 1) -> None:
        """Coefficients of complex columns, (n, columns); `out` may be `values`."""

    @abstractmethod
    def columns_inverse(self, coefficients: Array, out: Array, threads: int = 1) -> None:
        """Complex columns, (n, columns), of their coefficients; `out` may be `coefficients`."""

"""Exceptions of the package, and the form of messages: one line.

The message of a refused argument or key names it, shows its value and says what is accepted.
"""

import difflib
import sys
import traceback
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple, Self

# Most characters of a value in a message.
_LONGEST_VALUE = 60


class ConvergenceError(RuntimeError):
    """Raised when a contact problem was not solved to its tolerance.

    Attributes
    ----------
    residual, tolerance : float
        Residual that was reached, and the largest one accepted.
    iterations : int
        Number of applications of the compliance operator, on all grids.
    load : float
        Mean pressure when the solver stopped.

    Examples
    --------
    >>> height = asp.self_affine((32, 32), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> try:
    ...     asp.solve_contact(height, asp.Solid(young=1.0, poisson=0.3), mean_pressure=1e-4, rtol=1e-17)
    ... except asp.ConvergenceError as error:
    ...     print("not solved:", error.residual > error.tolerance)
    not solved: True
    """

    def __init__(
        self,
        reason: str,
        residual: float,
        tolerance: float,
        iterations: int,
        load: float,
        remedy: str = "",
    ) -> None:
        super().__init__(
            f"{reason}: residual {residual:.3g}, tolerance {tolerance:.3g}, "
            f"{iterations} iterations, mean pressure {load:.6g}" + (f"; {remedy}" if remedy else "")
        )
        self.residual = residual
        self.tolerance = tolerance
        self.iterations = iterations
        self.load = load
        self._reason, self._remedy = reason, remedy

    def __reduce__(self) -> tuple[Any, ...]:
        """The error from another process."""
        numbers = self.residual, self.tolerance, self.iterations, self.load
        return ConvergenceError, (self._reason, *numbers, self._remedy)

    def in_units(self, stress: float) -> "ConvergenceError":
        """The same error with the mean pressure multiplied by a unit of stress."""
        numbers = self.residual, self.tolerance, self.iterations, self.load * stress
        return ConvergenceError(self._reason, *numbers, self._remedy)


class DatasetError(RuntimeError):
    """Raised for a result file that is missing, damaged, or was changed after it was written."""


class Problem(NamedTuple):
    """Something that is not accepted: its argument or dotted key, and the rest of the message after it."""

    key: str
    text: str

    def __str__(self) -> str:
        return f"{self.key}{self.text}"


class InputError(ValueError):
    """Raised for input with one or several problems, given as texts or as keys and texts.

    Attributes
    ----------
    source : str
        File that has the problems; may be empty.
    problems : tuple of str
        Everything that is wrong or missing, each with the argument or option that it needs.
    found : tuple of Problem
        The same as data.
    """

    def __init__(self, source: str, problems: Iterable[str | tuple[str, str]]) -> None:
        self.source = source
        self.found = tuple(
            Problem("", each) if isinstance(each, str) else Problem(*each) for each in problems
        )
        self.problems = tuple(map(str, self.found))
        heading = f"{source}:" if source else f"{len(self.problems)} problems:"
        super().__init__(self.lines[0] if len(self.lines) == 1 else "\n  ".join([heading, *self.problems]))

    def __reduce__(self) -> tuple[Any, ...]:
        """The error from another process."""
        return type(self), (self.source, self.found)

    def renamed(self, name_of: Callable[[str], str]) -> Self:
        """The error with the names that its arguments have in another interface, such as flags."""
        return type(self)(self.source, [(key and name_of(key), text) for key, text in self.found])

    @property
    def lines(self) -> tuple[str, ...]:
        """A message for each problem."""
        return tuple(": ".join(filter(None, (self.source, problem))) for problem in self.problems)


class PlanError(ValueError):
    """Raised for a target of accuracy or cost that no measured combination of settings reaches."""


class PreflightError(RuntimeError):
    """Raised when a study cannot run on this machine; the message names the cause and the remedy."""


def is_refusal(error: BaseException) -> bool:
    """True if a ``raise`` statement made a ValueError or TypeError, not an operation such as None + 1."""
    last = traceback.extract_tb(error.__traceback__)[-1]
    return isinstance(error, (ValueError, TypeError)) and (last.line or "").startswith("raise ")


def one_line(message: str) -> str:
    """The message with line breaks and other unprintable characters escaped."""
    return "".join(c if c.isprintable() else repr(c)[1:-1] for c in message)


def shown(value: object) -> str:
    """The representation of a value for a message: one line of at most 60 characters."""
    try:
        text = one_line(repr(value))
    except ValueError:  # an integer of more digits than Python prints
        text = f"<{type(value).__name__}>"
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 3] + "..."


def did_you_mean(word: str, known: Iterable[str]) -> str:
    """End of a message on an unknown word: suggests the most similar known one; may be empty."""
    names, own = {name.lstrip("-"): name for name in known}, word.lstrip("-")
    longer = [name for name in names if own and name.startswith(own)]
    longer += [name for name in names if own in name.split("_")]
    found = longer or difflib.get_close_matches(own, list(names), 1, 0.7)
    return f"; did you mean {names[found[0]]}?" if found else ""


def fail(message: str, code: int = 1) -> int:
    """Print in one line on stderr why a command failed, and return the exit code."""
    print(f"asperity: {one_line(' '.join(message.split()))}", file=sys.stderr)
    return code

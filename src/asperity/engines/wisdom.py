"""Measured plans of FFTW as a text that later runs use: a wisdom.

FFTW chooses a plan by timing candidates. Two measurements may end with different plans, which round
differently. Runs that are to have the same bits therefore share one wisdom: a rule of the study makes it
once, as a file that is an input of the jobs. It is valid for one version of FFTW and one kind of processor.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from asperity.arguments import whole_number
from asperity.errors import shown
from asperity.packages import require
from asperity.types import Progress

LONGEST = 2**20
"""Longest line whose plans are measured."""

_TITLE = "plans of asperity for FFTW"

_NEEDED = "a file of `asperity wisdom` is needed"


@dataclass(frozen=True)
class Wisdom:
    """Measured plans.

    Parameters
    ----------
    plans : mapping
        Name of a plan (`asperity.engines.plans.Key`) → wisdom of FFTW from which it is made.
    """

    plans: Mapping[str, str]

    @cached_property
    def digest(self) -> str:
        """Short fingerprint of the plans."""
        return hashlib.sha256(json.dumps(self.plans, sort_keys=True).encode()).hexdigest()[:8]


def measure_wisdom(lengths: Iterable[int], progress: Progress | None = None) -> str:
    """Text of a wisdom file with the fastest plans for square grids, in both precisions.

    Takes about half a second for a length of 1024.

    Parameters
    ----------
    lengths : iterable of int
        Numbers of nodes on the edges of the grids, from 1 to `LONGEST`.
    progress : callable, optional
        Called as ``progress(done, total)``.

    Raises
    ------
    TypeError, ValueError
        If a length is not accepted.
    MissingPackageError
        If pyFFTW is not installed.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> height = asp.self_affine((64, 64), 0.8, 0.5, 0.125, rms_height=1e-3, seed=1)
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     wisdom = pathlib.Path(folder) / "wisdom.json"
    ...     characters = wisdom.write_text(asp.measure_wisdom([64]))
    ...     with asp.fft_engine("pyfftw", wisdom):
    ...         contact = asp.solve(height, asp.Layer(young=1.0, poisson=0.3), area_fraction=0.1)
    >>> contact.fft_engine
    'pyfftw ..., wisdom ...'
    """
    accepted = f"a whole number from 1 to {LONGEST}"
    wanted = sorted(
        {whole_number("lengths", length, accepted, lambda n: 1 <= n <= LONGEST) for length in lengths}
    )
    require(("pyfftw",))
    from asperity.engines.plans import PRECISIONS, keys_of, measure

    keys = [key for n in wanted for precision in PRECISIONS for key in keys_of(n, n, n, precision).values()]
    plans = {}
    for number, key in enumerate(keys, start=1):
        plans[key.name] = measure(key)
        if progress:
            progress(number, len(keys))
    return json.dumps({"title": _TITLE, "plans": plans}, indent=1) + "\n"


def read_wisdom(path: str | os.PathLike[str], option: str = "wisdom") -> Wisdom:
    """Wisdom of a file that holds the text of `measure_wisdom`; `option` is its name in messages.

    Raises
    ------
    ValueError
        If the file cannot be read, or holds no wisdom for the FFTW and the processor in use.
    """
    from asperity.engines.plans import is_known

    name = f"{option} = {shown(os.fspath(path))}"
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"{name}: cannot be read ({error.strerror}); {_NEEDED}") from error
    except ValueError as error:
        raise ValueError(f"{name}: {_NEEDED}") from error
    if not isinstance(content, dict) or content.get("title") != _TITLE:
        raise ValueError(f"{name}: {_NEEDED}")
    plans = content.get("plans")
    if not isinstance(plans, dict) or not all(isinstance(text, str) for text in plans.values()):
        raise ValueError(f"{name}: {_NEEDED}")
    samples = {key.rpartition(" ")[2]: text for key, text in plans.items()}  # all come from one FFTW
    if not all(is_known(precision, text) for precision, text in samples.items()):
        raise ValueError(
            f"{name}: measured with another FFTW or on another processor; a new file of `asperity wisdom`, "
            "in a study of rule fft_wisdom, is needed"
        )
    return Wisdom(plans)

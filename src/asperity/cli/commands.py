"""What the command line does: ``asperity solve | stress | peaks | plot | plan``.

Each command is one stage of the study, on files named by the caller, with the paper's settings where
none are given; its result is a file as the study's own, which the study's figures accept.
"""

from __future__ import annotations

import argparse
import inspect
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from importlib.resources import files
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import xarray as xr

import asperity
from asperity.errors import fail
from asperity.pipeline.contact import solve_contact
from asperity.pipeline.statistics import summarise
from asperity.pipeline.stress import compute_stress
from asperity.pipeline.surface import read_surface
from asperity.results import dataset
from asperity.runtime.progress import ProgressBar
from asperity.surface.measured import DETRENDS, PERIODICITIES
from asperity.surface.roughness import roughness_parameters

_MAP_OPTIONS = (
    "detrend",
    "periodic",
    "undefined",
    "wavelength_short",
    "points",
    "physical_size",
    "height_factor",
)
_COMPARE_STUDIES = ("fig16", "fig17")
_MARKS = {"surface": "spectrum", "contact": "pressure", "stress": "peak_value", "statistics": "peak_density"}
_MAKERS = {"contact": "asperity solve", "stress": "asperity stress", "statistics": "asperity peaks"}


def run(arguments: Sequence[str] | None = None) -> None:
    """Do what a command line says.

    Raises
    ------
    SystemExit
        With 2 and one line on stderr if it says nothing that can be done, as argparse does.
    ValueError, TypeError, OSError, ImportError, MemoryError, DatasetError, ConvergenceError
        If what it says cannot be done.
    """
    options = _parser().parse_args(arguments)
    _keep_inputs(options)
    options.run(options)


def solve(options: argparse.Namespace) -> None:
    """Press the solid against a surface."""
    surface, settings = _surface(options)
    layer = {
        "height": options.layer_height,
        "bottom": options.bottom,
        "poisson": options.poisson,
        "lateral": options.lateral,
        "half_space_tolerance": options.half_space_tolerance,
    }
    contact = {
        "method": options.method,
        "area_fraction": options.area_fraction,
        "path_area_fractions": sorted(options.path or []),
        "tolerance": options.tolerance,
        "precision": options.precision,
    }
    with ProgressBar(f"contact {settings['name']}") as progress:
        result = solve_contact(surface, layer, contact, progress=progress)
    _write(result, options.out, "Contact with rough surface", settings | {"layer": layer, "contact": contact})
    print(
        f"area fraction {float(result['area_fraction']):.6g}, "
        f"mean pressure {float(result['mean_pressure']):.6g} E*, approach {float(result['approach']):.6g}, "
        f"rms gradient in contact {float(result['gradient_rms_contact']):.6g}; {result.attrs['solid']}"
    )


def stress(options: argparse.Namespace) -> None:
    """Analyse the stress under a contact."""
    contact = _read(options.contact, "contact")
    settings = dataset.settings_of(contact)
    poisson = options.poisson
    own = settings["layer"]["poisson"]
    if poisson is None:
        poisson = [own]
    elif contact.attrs["solid"] != "half-space" and poisson != [own]:
        raise ValueError(
            f"--poisson {' '.join(f'{nu:g}' for nu in poisson)}: the contact was solved on a layer of "
            f"ratio {own:g}, which has that one only"
        )
    section = {
        "poisson": poisson,
        "tolerance": options.tolerance,
        "depth_spacing": options.depth_spacing,
    }
    with ProgressBar(f"stress {settings['name']}") as progress:
        result = compute_stress(contact, settings["layer"], section, progress=progress)
    _write(result, options.out, "Stress under rough surface", settings | {"stress": section})
    below = result["largest_von_mises"]
    for nu in result["poisson"].values:
        depth = float(result["reference_depth"].sel(poisson=nu))
        print(
            f"poisson {nu:g}: largest von Mises stress {float(below.sel(poisson=nu).max()):.6g} E* "
            f"at depth {depth:.6g}"
        )


def peaks(options: argparse.Namespace) -> None:
    """Distributions of the peaks of one surface, over its seeds."""
    from asperity.stress.statistics import selection

    if len(options.contact) != len(options.stress):
        raise ValueError(
            f"--contact: one for each stress is needed, {len(options.contact)} for {len(options.stress)} given"
        )
    stresses = [_read(path, "stress") for path in options.stress]
    contacts = [_read(path, "contact") for path in options.contact]
    for path, one, other in zip(options.stress, stresses, contacts, strict=True):
        made_from = {key: value for key, value in dataset.settings_of(one).items() if key != "stress"}
        if made_from != dataset.settings_of(other):
            raise ValueError(f"{path}: not of the contact given beside it; give them in the same order")
    settings = dataset.settings_of(stresses[0])
    section = {"bins": options.bins, "resamples": options.resamples, "confidence": options.confidence}
    settings |= {
        "statistics": section,
        "seed": [dataset.settings_of(one).get("seed") for one in stresses],
    }
    with ProgressBar(f"peaks {settings['name']}"):
        result = summarise([_pressed_surface(one) for one in contacts], contacts, stresses, **section)
    _write(result, options.out, "Statistics of rough surface", settings)
    print("quantity    poisson   peaks   50 %   90 %   99 %  (magnitudes over E* times rms gradient,")
    print("                                                  peaks as the figures count them)")
    for quantity in result["quantity"].values:
        for nu in result["poisson"].values:
            chosen = result.sel(quantity=quantity, poisson=nu, selection=selection(quantity))
            shown = "  ".join(
                f"{float(chosen['peak_percentile'].sel(percent=percent)):.3f}"
                for percent in (50.0, 90.0, 99.0)
            )
            print(f"{quantity:<12}{nu:>7g}{int(chosen['peak_counts'].sum()):>8}  {shown}")


def plot(options: argparse.Namespace) -> None:
    """Draw a figure of the paper from result files."""
    from asperity.paper.figures.style import save, style

    name = f"fig{options.figure:02d}"
    module = import_module(f"asperity.paper.figures.{name}")
    needed = list(inspect.signature(module.draw).parameters)
    given: dict[str, dict[str, xr.Dataset]] = {}
    for path in options.results:
        data = dataset.read(path)
        stage = _stage(data)
        if stage is None:
            raise ValueError(f"{path}: no result of surface, contact, stress or statistics")
        stages = given.setdefault(stage, {})
        stages[_free_name(dataset.settings_of(data)["name"], stages)] = data
    if "validation" in needed:
        raise ValueError(f"figure {options.figure} is drawn from the study's validation alone")
    for stage in needed:
        if stage not in given:
            maker = f" (of {_MAKERS[stage]})" if stage in _MAKERS else ""
            raise ValueError(f"figure {options.figure}: a {stage} file{maker} is needed, none is given")
    shown: dict[str, Any] = {stage: given[stage] for stage in needed}
    for stage in needed:
        if list(shown[stage]) != list(shown[needed[0]]):
            raise ValueError(f"figure {options.figure}: the same surfaces are needed from each stage")
    if name in _COMPARE_STUDIES:
        shown = {stage: {"given": results} for stage, results in shown.items()}
    with style():
        save(module.draw(**shown), *options.out)


def plan(options: argparse.Namespace) -> None:
    """What a calculation costs and how wrong it is, and settings for a target."""
    from asperity.accuracy import scenes as plan_config
    from asperity.accuracy.plan import PEAKS, assess, propose, report

    given = plan_config.read(options.config, options.area_fraction)
    surfaces, knobs, ratios = plan_config.scenes(given)
    scenes = list(surfaces.values())
    outputs = options.output or PEAKS
    memory = None if options.memory is None else options.memory * 2**30
    if options.error is None and options.seconds is None and memory is None:
        found = assess(scenes, knobs, ratios, options.one_surface)
    else:
        found = propose(scenes, outputs, options.error, options.seconds, memory, ratios, options.one_surface)
    print(report(found, surfaces, outputs, options.one_surface))


def _keep_inputs(options: argparse.Namespace) -> None:
    """Raise `ValueError` if a result would take the place of a file that it is made from."""
    outs, ins = (
        [Path(path) for name in names for path in np.atleast_1d(getattr(options, name, None) or [])]
        for names in (("out",), ("surface", "contact", "stress", "results"))
    )
    for out in outs:
        if out.is_dir():
            raise ValueError(f"--out {out}: a folder, the name of a file is needed")
        if any(out.exists() and path.exists() and out.samefile(path) for path in ins):
            raise ValueError(f"--out {out}: is read too, another name is needed")


def _surface(options: argparse.Namespace) -> tuple[xr.Dataset, dict[str, Any]]:
    """The surface to press against, from a result of the study or from a height map."""
    path = Path(options.surface)
    if not path.is_file():
        raise ValueError(f"{path}: no such file")
    given = {name: getattr(options, name) for name in _MAP_OPTIONS if getattr(options, name) is not None}
    if _is_result(path):
        if given:
            raise ValueError(f"--{next(iter(given)).replace('_', '-')}: for height maps, {path} is a surface")
        surface = _read(path, "surface")
        return surface, dataset.settings_of(surface)
    detrend = "tilt" if options.periodic in ("mirrored", "windowed") else "none"
    parameters = {"label": options.label or path.stem, "file": str(path), "detrend": detrend, **given}
    surface = read_surface(parameters)
    parameters["wavelength_short"] = surface.attrs["wavelength_short"]
    return surface, {"name": path.stem, "seed": 0, "surface": parameters}


def _is_result(path: Path) -> bool:
    """Whether the file is a result of this package, and not a map in another format."""
    try:
        with xr.open_dataset(path, engine="netcdf4") as opened:
            return "settings" in opened.attrs
    except (OSError, RuntimeError, ValueError):
        return False


def _read(path: str | Path, stage: str) -> xr.Dataset:
    data = dataset.read(path)
    found = _stage(data)
    if found != stage:
        what = f"of {found}" if found else "of no stage"
        raise ValueError(f"{path}: a result {what}, one of {stage} is needed")
    return data


def _stage(data: xr.Dataset) -> str | None:
    """Of which stage a result file is."""
    return next((stage for stage, mark in _MARKS.items() if mark in data), None)


def _free_name(name: str, taken: dict[str, xr.Dataset]) -> str:
    """The name, numbered if it is taken."""
    numbered = (f"{name} {number}" for number in range(2, len(taken) + 3))
    return next(candidate for candidate in (name, *numbered) if candidate not in taken)


def _pressed_surface(contact: xr.Dataset) -> xr.Dataset:
    """The surface that was pressed: gap = height + displacement − approach."""
    height = contact["gap"] - contact["displacement"] + contact["approach"]
    height = height - height.mean()
    measured = roughness_parameters(height.values, dataset.grid_of(contact).length)
    names = ("rms_height", "rms_gradient", "skewness", "kurtosis")
    return xr.Dataset({"height": height, **{name: getattr(measured, name) for name in names}})


def _write(result: xr.Dataset, path: str, title: str, settings: dict[str, Any]) -> None:
    dataset.write(result, path, title=f"{title} {settings['name']}", settings=settings)


def _number(
    accepted: str, holds: Callable[[float], bool], kind: Callable[[str], Any] = float
) -> Callable[[str], Any]:
    """A converter for argparse that tells what is accepted."""

    def convert(text: str) -> Any:
        try:
            value = kind(text)
        except ValueError:
            value = None
        if value is None or not (np.isfinite(value) and holds(value)):
            raise argparse.ArgumentTypeError(f"{text[:60]!r}: {accepted} is needed")
        return value

    return convert


def _figure_number(text: str) -> int:
    known = sorted(
        int(entry.name[3:5])
        for entry in files("asperity.paper.figures").iterdir()
        if entry.name.startswith("fig") and entry.name.endswith(".py")
    )
    number = text.lower().removeprefix("fig").removesuffix(".py")
    if not (number.isdigit() and int(number) in known):
        raise argparse.ArgumentTypeError(f"{text[:60]!r}: one of {', '.join(map(str, known))} is needed")
    return int(number)


_FRACTION = _number("a number > 0 and ≤ 1", lambda value: 0 < value <= 1)
_POSITIVE = _number("a number > 0", lambda value: value > 0)
_POISSON = _number("a number > -1 and ≤ 0.5", lambda value: -1 < value <= 0.5)


def _count(minimum: int, maximum: int) -> Callable[[str], Any]:
    return _number(
        f"a whole number ≥ {minimum} and ≤ {maximum}", lambda value: minimum <= value <= maximum, int
    )


class _Parser(argparse.ArgumentParser):
    """A parser that takes options by their whole names, and tells what is wrong in one line."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options, allow_abbrev=False)

    def error(self, message: str) -> NoReturn:
        """End with 2."""
        sys.exit(fail(f"{message} (see {self.prog} --help)", 2))


class _Help(argparse.ArgumentDefaultsHelpFormatter):
    """Help with the defaults where there are some."""

    def _get_help_string(self, action: argparse.Action) -> str | None:
        return action.help if action.default is None else super()._get_help_string(action)


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="asperity",
        description="Stress inside an elastic solid pressed against a rough surface. Lengths are in units of "
        "the longer edge of the cell, stresses in units of the effective modulus E/(1 - poisson^2).",
        epilog="The steps in order: solve, stress, peaks, plot; plan tells cost and error beforehand.",
    )
    parser.add_argument("--version", action="version", version=f"asperity {asperity.__version__}")
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")

    def command(run: Callable[[argparse.Namespace], None], description: str) -> argparse.ArgumentParser:
        added = commands.add_parser(
            run.__name__,
            help=description[0].lower() + description[1:].split(".")[0],
            description=description,
            formatter_class=_Help,
        )
        added.set_defaults(run=run)
        return added

    _add_solve(
        command(solve, "Press the solid against a surface. The result holds pressure, displacement, gap.")
    )
    _add_body(command(stress, "Find peaks, depth profile and decay of the stress under a contact."))
    _add_peaks(command(peaks, "Make the distributions of the peaks of one surface, and print percentiles."))
    _add_plot(
        command(plot, "Draw a figure of the paper from results. Give the files of every stage it shows.")
    )
    _add_plan(
        command(plan, "Tell cost and error before a calculation. With a target, find the settings for it.")
    )
    return parser


def _add_out(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--out", required=True, metavar="FILE.nc", help="where the result goes")


def _add_solve(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("surface", help="surface file of the study, or a height map of an instrument")
    _add_out(parser)
    add = parser.add_argument
    add("--area-fraction", type=_FRACTION, default=0.1, help="true contact area over nominal area")
    add("--path", type=_FRACTION, nargs="+", help="area fractions of a load-area curve as well")
    add("--poisson", type=_POISSON, default=0.33, help="Poisson's ratio")
    add("--layer-height", type=_POSITIVE, default=1.0, help="height of the elastic layer")
    add("--bottom", choices=("bonded", "frictionless"), default="bonded", help="what the layer rests on")
    add("--lateral", choices=("confined", "free"), default="confined", help="the uniform mode")
    add(
        "--half-space-tolerance",
        type=_number("a number ≥ 0 and ≤ 1", lambda value: 0 <= value <= 1),
        default=0.05,
        help="difference to the layer at which the half-space is used instead",
    )
    add("--method", choices=("active_set", "gfmd"), default="active_set", help="the solver")
    add(
        "--tolerance",
        type=_number("a number ≥ 1e-14 and ≤ 0.01", lambda value: 1e-14 <= value <= 0.01),
        default=1e-6,
        help="largest relative residual",
    )
    add("--precision", choices=("float64", "float32"), default="float64", help="floating-point precision")
    maps = parser.add_argument_group(
        "height maps", "a map shows its peaks upward and is pressed face down; options for maps only"
    )
    maps.add_argument("--label", help="how figures call the surface (default: the name of the file)")
    maps.add_argument("--periodic", choices=PERIODICITIES, help="how the map becomes one period")
    maps.add_argument(
        "--detrend",
        choices=DETRENDS,
        help="what is taken off first; tilt for mirrored and windowed maps if not given",
    )
    maps.add_argument("--undefined", choices=("harmonic",), help="how points without data are filled")
    maps.add_argument("--wavelength-short", type=_FRACTION, help="shorter waves are removed")
    maps.add_argument("--points", type=_count(8, 32768), help="nodes on the longer edge, interpolated")
    maps.add_argument(
        "--physical-size", type=_POSITIVE, nargs=2, metavar=("Y", "X"), help="edges, if the file does not say"
    )
    maps.add_argument("--height-factor", type=_POSITIVE, help="to heights, if the file does not say")


def _add_body(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("contact", help="result of asperity solve")
    _add_out(parser)
    add = parser.add_argument
    add("--poisson", type=_POISSON, nargs="+", help="one ratio or several; that of the contact if not given")
    add(
        "--tolerance",
        type=_number("a number ≥ 0 and ≤ 0.1", lambda value: 0 <= value <= 0.1),
        default=1e-4,
        help="error allowed where a deep plane is computed on a coarser grid",
    )
    add(
        "--depth-spacing",
        type=_number("a number ≥ 0.05 and ≤ 4", lambda value: 0.05 <= value <= 4),
        default=0.5,
        help="distance of the upper planes in grid spacings",
    )


def _add_peaks(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "stress", nargs="+", help="results of asperity stress, one for each seed of one surface"
    )
    parser.add_argument(
        "--contact", nargs="+", required=True, metavar="FILE.nc", help="their contacts, in the same order"
    )
    _add_out(parser)
    add = parser.add_argument
    add("--bins", type=_count(2, 10000), default=100, help="bins of every probability density")
    add("--resamples", type=_count(10, 100000), default=1000, help="bootstrap resamples over the seeds")
    add(
        "--confidence",
        type=_number("a number > 0 and < 1", lambda value: 0 < value < 1),
        default=0.95,
        help="confidence of the bands",
    )


def _add_plot(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("figure", type=_figure_number, help="number of the figure, such as 9")
    parser.add_argument("results", nargs="+", help="result files of the stages that the figure shows")
    parser.add_argument(
        "--out", nargs="+", required=True, metavar="FILE", help="pictures to write, such as fig.png fig.pdf"
    )


def _add_plan(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "config",
        nargs="+",
        metavar="CONFIG_OR_SPECTRUM",
        help="configuration and overlays of the study, or a spectrum: a file or the text itself, such as "
        "'{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.004}'",
    )
    add = parser.add_argument
    add("--error", type=_POSITIVE, help="largest relative error of the outputs; the cheapest settings follow")
    add(
        "--output",
        nargs="+",
        metavar="NAME",
        help="outputs that are to be right, such as von_mises_p99 or peak_depth (default: peaks)",
    )
    add("--seconds", type=_POSITIVE, help="processor time for all surfaces and seeds, on one thread")
    add("--memory", type=_POSITIVE, metavar="GIB", help="memory of one process")
    add("--area-fraction", type=_FRACTION, help="true contact area over nominal area")
    add(
        "--one-surface",
        action="store_true",
        help="errors of this very surface, not of the mean over its kind: one seed will do",
    )

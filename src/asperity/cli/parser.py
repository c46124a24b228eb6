"""The commands of ``asperity`` and their arguments."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from functools import partial

import asperity
from asperity.cli import engine
from asperity.cli.arguments import POSITIVE, Parser, add_setting, converted
from asperity.cli.run_options import RUN_MAP_OPTIONS, RUN_OPTIONS
from asperity.config.schema import setting
from asperity.paper.figures import numbers

VIEWS = ("height", "pressure", "gap", "section", "plane", "peaks")
"""Pictures that ``asperity view`` draws."""


def make_parser() -> Parser:
    """Parser of the command line; its result names the command as ``command``."""
    parser = Parser(
        prog="asperity",
        description="Stress inside an elastic solid pressed against a rough surface. The command run takes a "
        "measured map, materials and a load with their units. The others have lengths in units of the longer "
        "edge of the periodic cell, stresses in units of the effective modulus E/(1 - poisson^2).",
        epilog="From a map to an answer: run. The steps of a calculation: surface, solve, stress, peaks, "
        "plot. Its cost and error beforehand: plan. Means over random surfaces: ensemble. Pictures and "
        "tables of its results: view, export. The study of the paper: study.",
    )
    parser.add_argument("--version", action="version", version=f"asperity {asperity.__version__}")
    commands = parser.add_subparsers(title="commands", required=True, dest="command", metavar="COMMAND")
    for name, (add_arguments, description) in _COMMANDS.items():
        summary = description.split(".")[0]
        command = commands.add_parser(name, help=summary[0].lower() + summary[1:], description=description)
        add_arguments(command)
        if name in engine.COMMANDS:
            engine.add_engine(command)
    return parser


def _add_run(parser: Parser) -> None:
    parser.add_argument("map", metavar="MAP", help="height map of an instrument, peaks upward")
    parser.add_argument("--out", metavar="FOLDER", help="folder for results, pictures and report")
    parser.add_argument(
        "--config",
        metavar="FILE",
        help="YAML file whose section `engineering` has values of options left out",
    )
    body = parser.add_argument_group("body and counter body")
    body.add_argument("--rigid", action="store_true", help="the counter body is rigid, as it is by default")
    load = parser.add_argument_group("load", "Exactly one of these is needed.")
    maps = parser.add_argument_group("map")
    counter = parser.add_argument_group(
        "map of the counter body",
        "Its peaks are upward as measured: it is turned over and laid on the other map, middle on middle.",
    )
    groups = {
        "body": body,
        "load": load,
        "map": maps,
        "counter": counter,
        "stress": parser.add_argument_group("stress"),
    }
    for option in (*RUN_OPTIONS, *RUN_MAP_OPTIONS):
        group = groups[option.group]
        # The command itself checks the texts, so that it can report everything that is wrong at once.
        add_setting(
            group, option.flag, option.key, left_out=option.left_out, type=str, action="store", **option.shown
        )


def _add_solve(parser: Parser) -> None:
    parser.add_argument("surface", help="surface file of the study, or height map of an instrument")
    _add_out(parser)
    add = partial(add_setting, parser)
    loads = parser.add_argument_group("load", "At most one of these is accepted.")
    add_setting(
        loads, "--area-fraction", "contact.area_fraction", left_out="0.1, if no other quantity is imposed"
    )
    for name, dimension, text in (
        (
            "mean_pressure",
            "pressure",
            "load over the nominal area: a pressure such as 50MPa, or a number in E*",
        ),
        ("force", "force", "load on the cell, or on the area of a mirrored map, such as 12N"),
        (
            "approach",
            "length",
            "approach of the bodies since first touch: a length such as 200nm, or a number in cell lengths",
        ),
    ):
        loads.add_argument(f"--{name.replace('_', '-')}", metavar=dimension.upper(), help=text)
    add("--path", "contact.path_area_fractions")
    add("--poisson", "layer.poisson")
    add("--layer-height", "layer.height")
    add("--bottom", "layer.bottom")
    add("--lateral", "layer.lateral")
    add(
        "--young",
        "engineering.young",
        left_out="the result is dimensionless, in cell lengths and effective moduli",
        dest="young",
        metavar="PRESSURE",
    )
    add("--half-space-tolerance", "layer.half_space_tolerance")
    add("--method", "contact.method")
    add("--tolerance", "contact.tolerance")
    add("--precision", "contact.precision")
    maps = parser.add_argument_group(
        "height maps",
        "A map shows its peaks upward and is pressed face down. Not accepted for surface files.",
    )
    add = partial(add_setting, maps)
    add("--label", "measured.NAME.label", left_out="name of the file")
    add("--periodic", "measured.NAME.periodic")
    add("--detrend", "measured.NAME.detrend")
    add("--undefined", "measured.NAME.undefined")
    add("--wavelength-short", "measured.NAME.wavelength_short")
    add("--points", "measured.NAME.points", left_out="those of the map")
    add("--despike", "measured.NAME.despike")
    _add_reading(maps)


def _add_reading(parser: argparse._ActionsContainer) -> None:
    """Add the arguments for what a map's file does not say."""
    add = partial(add_setting, parser)
    add("--channel", "measured.NAME.channel")
    add("--unit", "measured.NAME.unit")
    add("--physical-size", "measured.NAME.physical_size", metavar=("Y", "X"))
    add("--height-factor", "measured.NAME.height_factor")
    add("--orientation", "measured.NAME.orientation")
    add("--max-memory", "measured.NAME.max_memory", metavar="GIB")


def _add_info(parser: Parser) -> None:
    parser.add_argument("map", help="height map of an instrument, points x y z, or an array")
    _add_reading(parser)


def _add_stress(parser: Parser) -> None:
    parser.add_argument("contact", help="result of asperity solve")
    _add_out(parser)
    add_setting(parser, "--poisson", "stress.poisson")
    add_setting(parser, "--tolerance", "stress.tolerance")
    add_setting(parser, "--depth-spacing", "stress.depth_spacing")


def _add_peaks(parser: Parser) -> None:
    parser.add_argument("stress", nargs="+", help="results of asperity stress, one per seed of a surface")
    parser.add_argument(
        "--contact",
        nargs="+",
        required=True,
        metavar="FILE.nc",
        help="results of asperity solve, in the same order",
    )
    _add_out(parser)
    add_setting(parser, "--bins", "statistics.bins")
    add_setting(parser, "--resamples", "statistics.resamples")
    add_setting(parser, "--confidence", "statistics.confidence")


def _add_plot(parser: Parser) -> None:
    parser.add_argument("figure", type=_figure_number, help="number of a figure of the paper, such as 9")
    parser.add_argument("results", nargs="+", help="result files of all stages that the figure shows")
    parser.add_argument(
        "--out", nargs="+", required=True, metavar="FILE", help="images to write, such as fig.png fig.pdf"
    )
    add_setting(parser, "--poisson", "layer.poisson", left_out="that of the contact")


def _add_plan(parser: Parser) -> None:
    parser.add_argument(
        "config",
        nargs="+",
        metavar="CONFIG_OR_SPECTRUM",
        help="configuration and overlays, or a spectrum: files, or YAML text such as "
        "'{hurst: 0.8, wavelength_long: 0.125, wavelength_short: 0.004}'",
    )
    add = partial(parser.add_argument, type=partial(converted, POSITIVE), metavar="NUMBER")
    add(
        "--error",
        help="largest relative error of the outputs; the cheapest settings that reach it are proposed",
    )
    add("--seconds", help="processor time for all surfaces and seeds, on one thread")
    add("--memory", metavar="GIB", help="memory of one process")
    add_setting(parser, "--area-fraction", "contact.area_fraction", left_out="that of the configuration")
    parser.add_argument(
        "--output",
        nargs="+",
        metavar="NAME",
        help="outputs whose error counts, such as von_mises_p99 or peak_depth (default: peaks)",
    )
    parser.add_argument(
        "--one-surface",
        action="store_true",
        help="errors of this one surface, not of the mean over its kind, so that one seed is enough",
    )


def _add_ensemble(parser: Parser) -> None:
    parser.add_argument(
        "--claim",
        required=True,
        metavar="NAME",
        help="identifier of a claim, such as one_and_a_half, or a number of one surface, such as "
        "von_mises_p99_large_hurst; an unknown name lists all",
    )
    parser.add_argument(
        "--reading",
        nargs="+",
        action="extend",
        default=[],
        metavar="CHOICE=OPTION",
        help="choices of the readings on which the number depends, such as lateral=free (default: the "
        "study's own)",
    )
    parser.add_argument(
        "--error",
        metavar="SHARE",
        help="standard error and bias together, over the value, such as 0.5%% (default: that of the "
        "configuration)",
    )
    parser.add_argument(
        "--config", nargs="+", metavar="FILE", help="configuration, then overlays (default: the paper's)"
    )
    parser.add_argument(
        "--results", metavar="FOLDER", help="folder of results, instead of the configured one"
    )
    parser.add_argument(
        "--plan", action="store_true", help="compute the pilot only; print the seeds and the time to go"
    )
    parser.add_argument(
        "snakemake",
        nargs="*",
        metavar="OPTION",
        help="options of Snakemake, after --, such as -- --profile profiles/slurm",
    )


def _add_surface(parser: Parser) -> None:
    parser.add_argument("--out", required=True, metavar="FILE.nc", help="surface file to write")
    add = partial(add_setting, parser)
    add("--hurst", "surfaces.NAME.hurst", required=True)
    for name in ("wavelength_long", "wavelength_short", "rms_height"):
        key = f"surfaces.NAME.{name}"
        description = setting(key)["description"].rstrip(".")
        add(
            f"--{name.replace('_', '-')}",
            key,
            required=True,
            type=str,
            metavar="LENGTH",
            help=f"{description}: in cell lengths such as 0.1, or with --length such as 10um",
        )
    add("--points", "surfaces.NAME.points", left_out="those of the default preset")
    parser.add_argument(
        "--length", metavar="LENGTH", help="edge of the cell, such as 100um: the surface is in SI units"
    )
    parser.add_argument(
        "--seed",
        type=partial(converted, setting("seeds")["items"]),
        default=1,
        metavar="INTEGER",
        help="seed of the random surface (default: 1)",
    )
    add("--skewness", "surfaces.NAME.moments.skewness", left_out="Gaussian heights")
    add("--kurtosis", "surfaces.NAME.moments.kurtosis", left_out="Gaussian heights")
    add("--label", "surfaces.NAME.label", left_out="the Hurst exponent")


def _add_view(parser: Parser) -> None:
    parser.usage = "asperity view RESULT [RESULT ...] VIEW [PLACE ...] [options]"
    parser.add_argument(
        "words",
        nargs="+",
        metavar="RESULT VIEW PLACE",
        help="result files of one stage; what to draw: height, pressure or gap over the cell, section "
        "(vertical), plane (at a depth) or peaks; and where: y=205um (or x=) of a section and "
        "depth=40um to which it is drawn; depth=10um or depth=max of a plane; x=100-200um the part "
        "that is drawn. Lengths have units if the result is in SI, else they are in cell lengths",
    )
    parser.add_argument(
        "--field", metavar="NAME", help="stress that is drawn, such as von_mises or xx (default: von_mises)"
    )
    add_setting(parser, "--poisson", "layer.poisson", left_out="that of the contact")
    _add_body(parser)
    parser.add_argument(
        "--out",
        nargs="+",
        metavar="FILE",
        help="pictures to write, such as a.png a.pdf (default: RESULT_VIEW.png beside the first result)",
    )


def _add_body(parser: Parser) -> None:
    """Add the arguments that say in which body and under which friction the stress is computed."""
    parser.add_argument(
        "--body",
        choices=("lower", "upper"),
        default="lower",
        help="body of two elastic ones whose stress is shown (default: lower)",
    )
    add = partial(add_setting, parser, left_out="that of the result")
    add("--friction", "engineering.friction")
    add("--sliding-direction", "engineering.sliding_direction", metavar="DIRECTION")


def _add_export(parser: Parser) -> None:
    parser.add_argument(
        "results", nargs="+", metavar="RESULT", help="a contact or surface file, a stress file, or both"
    )
    parser.add_argument(
        "--peaks",
        metavar="FILE.csv",
        help="table of all peaks of the stress file, .csv or .parquet, for pandas or Excel",
    )
    parser.add_argument(
        "--field",
        nargs=2,
        action="append",
        metavar=("NAMES:DEPTHS", "FILE.vti"),
        help="fields of the stress under the contact file in a box, such as von_mises,xx:0-40um field.vti, "
        "for ParaView or pyvista; may be given several times",
    )
    parser.add_argument(
        "--surface",
        action="append",
        metavar="FILE",
        help="height, contact pressure, gap and displacement over the surface: FILE.vti for ParaView, "
        "FILE.csv with a row for each node; may be given several times",
    )
    parser.add_argument(
        "--profile",
        nargs=2,
        action="append",
        metavar=("PLACE", "FILE.csv"),
        help="the same fields along a line, such as y=205um line.csv; may be given several times",
    )
    parser.add_argument("--y", metavar="RANGE", help="part of the cell along y, such as 0-100um")
    parser.add_argument("--x", metavar="RANGE", help="part of the cell along x")
    parser.add_argument(
        "--spacing", metavar="LENGTH", help="distance between planes (default: that between nodes)"
    )
    add_setting(parser, "--poisson", "layer.poisson", left_out="that of the contact")
    _add_body(parser)


def _add_wisdom(parser: Parser) -> None:
    parser.add_argument(
        "--points",
        nargs="+",
        required=True,
        type=partial(converted, setting("surfaces.NAME.points")),
        metavar="INTEGER",
        help="nodes on the edges of the grids; coarser grids of the same calculation are planned too",
    )
    parser.add_argument("--out", required=True, metavar="FILE.json", help="file to write")


def _add_study(parser: Parser) -> None:
    parser.usage = "asperity study init FOLDER"
    parser.add_argument("action", choices=("init",), help="write the study into a folder")
    parser.add_argument("folder", metavar="FOLDER", help="new or empty folder")


_COMMANDS: dict[str, tuple[Callable[[Parser], None], str]] = {
    "run": (
        _add_run,
        "Answer from a measured map, materials and a load: contact, pressure, stress, yield. Writes results, "
        "pictures and a report.",
    ),
    "surface": (_add_surface, "Make a random rough surface."),
    "solve": (
        _add_solve,
        "Press the solid against a surface. The result holds pressure, displacement and gap.",
    ),
    "info": (
        _add_info,
        "Describe a height map: size, unit, missing points, spikes, roughness, spectrum. Then say what a "
        "calculation needs to be told.",
    ),
    "stress": (_add_stress, "Find the peaks, the depth profile and the decay of the stress under a contact."),
    "peaks": (_add_peaks, "Make the distributions of the peaks of a surface, and print percentiles."),
    "plot": (
        _add_plot,
        "Draw a figure of the paper. It needs the results of every stage that the figure shows.",
    ),
    "plan": (
        _add_plan,
        "Predict cost and error of a calculation. With a target, propose settings that reach it.",
    ),
    "ensemble": (
        _add_ensemble,
        "Estimate the mean of a number over random surfaces to a given error. Few seeds on fine grids and "
        "many on coarse ones are computed as jobs of the study, and kept for the next call.",
    ),
    "view": (_add_view, "Draw results: surfaces, contacts, and the stress below them."),
    "export": (_add_export, "Export results as tables (CSV) and as fields for ParaView (VTK)."),
    "wisdom": (
        _add_wisdom,
        "Measure the fastest plans of FFTW for some grids. The file serves --fft-wisdom of other commands.",
    ),
    "study": (
        _add_study,
        "Write the study of the paper into a folder. There `snakemake --cores 2` makes every figure.",
    ),
}


def _add_out(parser: Parser) -> None:
    parser.add_argument("--out", required=True, metavar="FILE.nc", help="result file to write")


def _figure_number(text: str) -> int:
    """Number of a figure that can be drawn, from text such as ``9`` or ``fig09``."""
    known = numbers()
    number = text.lower().removeprefix("fig").removesuffix(".py")
    if not (number.isdecimal() and int(number) in known):
        raise argparse.ArgumentTypeError(f"{text[:60]!r}: one of {', '.join(map(str, known))} is needed")
    return int(number)

"""Tables of wrong configurations, command lines and height maps, with the line that each is answered with."""

import contextlib
import io
from pathlib import Path

import numpy as np
from small_study import CONTACT, LAYER, STRESS, SURFACE

import asperity as asp
from asperity.cli import main as cli
from asperity.results import dataset
from asperity.settings import __main__ as config
from asperity.study.stages.contact import press_surface
from asperity.study.stages.statistics import SeedResults, surface_statistics
from asperity.study.stages.stress import compute_stress
from asperity.study.stages.surface import make_surface

ROOT = Path(__file__).parents[1]
DATA = ROOT / "tests/data"
PAPER = str(ROOT / "config/config.yaml")
LONG = "x" * 300 + ".nc"
"""Longer than a file name may be."""


MERGES = "a: &a {x: 1}\n" + "".join(
    f"{now}: &{now} {{<<: [{', '.join([f'*{last}'] * 9)}]}}\n"
    for last, now in zip("abcdefg", "bcdefgh", strict=True)
)

CONFIGS = [
    ("contact: {tolerance: '1e-6'}", "contact.tolerance = '1e-6': a number ≥ 1e-14 and ≤ 0.01 is needed"),
    (
        "contact: {area_fraction: 0.1}",
        "contact.area_fraction: unknown key; did you mean contact_area_fraction?",
    ),
    ("contact: {young: 0.1}", "contact.young: unknown key; known here are method, contact_area_fraction"),
    ("contact: {method: magic}", "contact.method = 'magic': gfmd or active_set"),
    ("surfaces: {hurst_02: {points: 256}}", "surfaces.hurst_02.points = 256: at least 512 are needed"),
    ("surfaces: {hurst_02: {wavelength_short: 0.5}}", "wavelength_short = 0.5: at most wavelength_long = 0."),
    ("surfaces: {gaussian: {wavelength_short: 0.0001}}", "surfaces.gaussian.points: 80000 are too many"),
    ("surfaces: {'H=0.2': {hurst: 0.2}}", "surfaces.'H=0.2': a name of at most 40 lower-case"),
    ("surfaces: {hurst_02: {johnson: {gamma: 1}}}", "surfaces.hurst_02.johnson.delta: missing; a number > 0"),
    ("studies: {hurst: [unknown]}", "studies.hurst = 'unknown': the name of a surface is needed (hurst_02"),
    (
        "surfaces: {hurst_02: {heights: {moments: {skewness: 2, kurtosis: 4}}}}",
        "hurst_02.heights.moments.kurtosis = 4: ",
    ),
    (
        "surfaces: {skew_positive: {heights: {moments: {skewness: 0, kurtosis: 3}}}}",
        "skew_positive.heights: only one",
    ),
    ("surfaces: {hurst_02: {heights: {map: {file: no.nid}}}}", "surfaces.hurst_02.heights.map.file = 'no.ni"),
    ("studies: {compressibility: [hurst_02, hurst_08]}", "studies.compressibility = ['hurst_02', 'hurst_08'"),
    ("stress: {poisson: [0.33, 0.33]}", "stress.poisson = [0.33, 0.33]: a list of 1 to 16 distinct items"),
    ('surfaces: {hurst_02: {label: "\\e[31mred"}}', "label = '\\x1b[31mred': text that can be printed is ne"),
    ("measured: {fault: {file: /dev/zero}}", "measured.fault.file = '/dev/zero': no such file"),
    ("layer: {poisson: 0.2}\nstress: {poisson: [0.3]}", "layer.poisson = 0.2 must be one of them"),
    (
        "contact: {contact_area_fraction: 0.1, normal_approach: 0.1}",
        "contact.normal_approach = 0.1: not accepted together with",
    ),
    ("contact: {precision: float32, tolerance: 1.0e-9}", "contact.tolerance = 1e-09: a number ≥ 1e-06 with"),
    ("", "overlay.yaml: keys with values are needed"),
    (b"#" * (2**17 + 1), "overlay.yaml: a configuration of at most 131072 bytes is needed"),
    ("seeds: [1]\ncontact: {}\nseeds: [2]", "'seeds' is given twice, again in line 3"),
    ("body: {poisson: [0.33]}", "body: unknown key; known here are based_on"),
    ("measured: {fault: {file: 'a{b}.asc'}}", "measured.fault.file = 'a{b}.asc': a file name without braces"),
    ("surfaces: {hurst_02: {label: 'a $ sign'}}", "mathematics between two dollar signs is needed"),
    ("seeds: !!python/object/apply:os.system ['touch pwned']", "overlay.yaml: YAML is needed; could not det"),
    (MERGES, "overlay.yaml: at most 100000 values are accepted, line 6 has more"),
    (
        f"contact: {{contact_area_fraction: {':'.join(['59'] * 10_000)}}}",
        "overlay.yaml: at most 2000 characters are",
    ),
    ("contact: " + "[" * 40 + "]" * 40, "overlay.yaml: at most 32 levels are accepted, line 1 has more"),
]


SMALL = SURFACE | {"wavelength_long": 0.5}
STAGES = ("surface", "contact", "stress", "statistics")


def make_chain(folder):
    """Results of one surface, contact, stress and statistics, made in a folder by the stages of the study."""
    surface = make_surface(SMALL, 1)
    contact = press_surface(
        surface, LAYER, CONTACT | {"contact_area_fraction": 0.2, "path_contact_area_fractions": [0.2]}
    )
    stress = compute_stress(contact, LAYER, STRESS)[LAYER["lateral"]]
    statistics = surface_statistics([SeedResults(1, surface, contact, stress)], 60, 1000, 0.95)
    settings = {"name": "small", "seed": 1, "surface": SMALL, "layer": LAYER, "stress": STRESS}
    paths = {stage: str(folder / f"{stage}.nc") for stage in STAGES}
    for path, result in zip(paths.values(), (surface, contact, stress, statistics), strict=True):
        dataset.write(result, path, "A small study", settings)
    return paths


HUGE = "9" * 5000
SPECTRUM = '{"hurst":0.8,"wavelength_long":0.125,"wavelength_short":0.01}'
RUN = "run {surface} --young 1GPa --poisson 0.3 --unit m --out {folder}/out"

RUNS = [
    ("--force 1N --force=2N", "--force: given 2 times"),
    (f"--force 1N --set load_curve.loads=[{','.join(map(str, range(1, 101)))}]", "load_curve.loads = "),
    ("--force 1N --set sliding", "--set 'sliding': KEY=VALUE is needed, such as body.hardness="),
    ("--force 1N --set slidng.friction=0.1", "slidng: unknown key; did you mean sliding?"),
    ("--force 1N --set body.layers=2", "body.layers = 2: a list of groups of keys is needed"),
    ("--mean-pressure 1,2GPa", "(kPa, MPa, GPa, N/mm^2; with a decimal point, not a comma: 1.2GPa) is need"),
    ("--mean-pressure 1MPa --hardness 700HV", "(kPa, MPa, GPa, N/mm^2; 700 HV is 6.865 GPa) or in"),
    ("--mean-pressure 5Mpa", "(kPa, MPa, GPa, N/mm^2; did you mean 5 MPa?) is needed"),
    (
        "--normal-approach -3nm",
        "--normal-approach = '-3nm': a length > 0 with its unit (nm, um, mm, m) is need",
    ),
    ("--force -.5 N", "--force = '-.5 N': a force > 0 with its unit (mN, N, kN) is needed"),
    ("--contact-area-fraction -1e-3", "--contact-area-fraction = -0.001: a number > 0 and ≤ 1 is needed"),
    ("--set load.hertz_pressure=1GPa", "--hertz-pressure: needs radius_x"),
    (
        "--set load.radius_x=5mm --contact-area-fraction 0.1",
        "--contact-area-fraction: hertz_pressure, force or",
    ),
]
"""What follows the map, the body and the folder of a run, and the line that refuses it."""

COMMANDS = [
    ("polish", 2, "'polish': one of run, compare"),
    ("solve s.nc", 2, "'solve': one of run, compare"),
    ("study init", 2, "the following arguments are required: FOLDER"),
    ("view {contact} gap --ot x.png", 2, "--ot: not accepted; did you mean --out?"),
    (f"plan {SPECTRUM} --contact-area-fraction {HUGE}", 2, "999...: a number is needed"),
    (
        f"plan {SPECTRUM} --contact-area-fraction 3",
        1,
        "contact.contact_area_fraction = 3.0: a number > 0 and ≤ 1 is needed",
    ),
    ("view {contact} plane --poisson 7", 1, "--poisson = 7.0: a number > -1 and ≤ 0.5 is needed"),
    ("view {contact} gap --fft-engine \u00fc\x1b[31m", 1, "--fft-engine = 'ü\\x1b[31m': ducc0 or pyfftw o"),
    ("view {folder}/none.nc gap", 1, "none.nc: no such file"),
    ("view {contact} gap --out {folder}", 1, "a folder, the name of a file is needed"),
    ("view {contact} gap --out x.docx", 1, "x.docx: the name of a picture is needed, ending in .p"),
    # names that are too long for a file
    (f"view {{contact}} gap --out {{folder}}/{LONG}", 1, "File name too long"),
    ("info {surface} --unit 7", 1, "--unit = '7': a unit of length such as nm, um, mm or m"),
    (f"plan {SPECTRUM} --error 1e-9", 1, "error = 1e-09: 0."),
    ("plan none.yaml", 1, "'none.yaml': a file, or keys and values such as"),
    ('plan {"hurst":[', 1, "YAML is needed; "),
    ("run map.x3p --poison 0.3", 2, "--poison: not accepted; did you mean --poisson?"),
    (
        "run {surface} --unit m --out {folder}/out --mean-pressure 5MPa",
        2,
        "--material, or --young and --poisson: missing",
    ),
    ("run map.x3p --pressure 5MPa", 2, "--pressure: not accepted; did you mean --mean-pressure?"),
    # exports
    ("export {contact}", 1, "nothing to export: --peaks FILE.csv, --surface FILE.vti,"),
    ("export {folder} --peaks p.csv", 1, "{folder}: the folder of an answer of asperity run is needed"),
    ("export {contact} --peaks p.csv", 1, "--peaks: a stress file (of asperity run or asp.analyse_stress)"),
    ("export {stress} --peaks p.xlsx", 1, "p.xlsx: a name that ends in .csv is needed"),
    ("export {contact} --field xx f.vti", 1, "--field 'xx': NAMES:DEPTHS, such as von_mises,xx:0-40um, is"),
    ("export {contact} --field xx:1 f.vti", 1, "--field = '1': a range such as 0-0.1 is needed"),
    ("export {contact} --field xx:0-1 f.vti --x 0-3", 1, "x = 0 to 3: rising positions from 0 to 1 are"),
    # pictures
    ("view {contact}", 1, "result files and one of height, pressure, gap, section, plane, peaks are needed"),
    ("view {stress} gap", 1, "a result of stress, one of contact is needed"),
    ("view {contact} section y=0.1 x=0.1", 1, "y, x: a number or max for one of them"),
    ("view {contact} height x=3", 1, "x = '3': a range such as 0-0.1 is needed"),
    ("view {contact} height --field xx", 1, "--field: not for height, only for section, plane and peaks"),
    ("view {contact_in_si} section y=205", 1, "y = '205': a number with a unit of length"),
    *((f"{RUN} {words}", 2, line) for words, line in RUNS),
]

HEADER = "# Channel: Height\n# Width: 8 m\n# Height: 8 m\n# Value units: m\n"
ROWS = [[f"{np.sin(3.0 * y) * np.cos(2.0 * x):.6f}" for x in range(8)] for y in range(8)]


def matrix(rows, header=HEADER):
    """Height map as text."""
    return (header + "\n".join(" ".join(row) for row in rows) + "\n").encode()


def saved(array):
    """Array in the format of numpy."""
    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


class Intruder:
    """Object that writes a file when it is unpickled."""

    def __reduce__(self):
        return open, ("pwned", "w")


MIRRORED = {"periodic": "mirrored"}
MAPS = [
    ("map.asc", matrix(ROWS), {}, "set it to declared, mirrored or windowed"),
    ("nan.asc", matrix([*ROWS[:7], ["nan", *ROWS[7][1:]]]), MIRRORED, "undefined: 1 points of the map"),
    ("bare.asc", matrix(ROWS, ""), MIRRORED, "physical_size: the file does not say"),
    ("pickle.npy", saved(np.array([[Intruder()] * 4] * 4)), MIRRORED, "pickle.npy: not a height map"),
    ("short.asc", matrix(ROWS), MIRRORED | {"wavelength_short": 1e-4}, "wavelength_short = 100 µm: a number"),
    ("gwyddion.x3p", (DATA / "steel.gwy").read_bytes(), MIRRORED, "its name is of format x3p, its"),
]

HALF_SPACE = asp.Solid(1.0, 0.3)
STEP = {"method": "active_set", "normal_approach": 0.9, "tolerance": 1e-6, "precision": "float64"}


def loaded(of):
    """The half-space under the pressure of a chain."""
    return asp.LoadedSolid(of("contact").pressure.values, asp.Grid((64, 64)), HALF_SPACE)


def covering(surface, fraction):
    return asp.solve_contact(surface.height, HALF_SPACE, contact_area_fraction=fraction)


BAND = {"hurst": 0.8, "wavelength_long": 0.25, "wavelength_short": 0.05, "rms_height": 0.001, "seed": 1}
CALLS = [
    (lambda of: asp.self_affine((64, 64), **BAND | {"wavelength_short": 0.5}), "wavelength_short = 0.5: "),
    (lambda of: asp.self_affine((16, 16), **BAND), "wavelength_short = 0.05: "),
    (lambda of: asp.surface.with_moments(asp.self_affine((64, 64), **BAND), 1.0, 2.0), "no Johnson curve"),
    (lambda of: press_surface(of("surface"), LAYER, STEP), "normal_approach = 0.9: less than 0.0"),
    (lambda of: covering(of("surface"), 10**400), "contact_area_fraction = 1"),
    (lambda of: covering(of("surface"), -0.1), "contact_area_fraction = -0.1"),
    (lambda of: asp.analyse_stress(loaded(of), poisson=[0.2, 0.2]), "poisson = 0.2: given 2 times"),
    (lambda of: asp.stress.pool_peaks([of("stress")] * 2, [0.1], bins=20), "gradients"),
    (lambda of: asp.read_result("none.nc"), "none.nc: no such file"),
    (lambda of: asp.write_result(of("contact"), LONG, "Contact"), "File name too long"),
    (lambda of: asp.write_result(of("contact"), ".", "Contact"), "is needed"),
    (lambda of: asp.views.plot_pressure(of("contact")).savefig("x.docx"), "is not supported"),
]
"""Calls of the library with the results of a chain by stage, and the line that each is answered with."""


def answer(function, arguments):
    """Exit code of a command, and what it prints on stderr."""
    said = io.StringIO()
    with contextlib.redirect_stderr(said), contextlib.redirect_stdout(io.StringIO()):
        try:
            code = function(arguments)
        except SystemExit as stopped:
            code = stopped.code
    return code, said.getvalue()


def answer_to_config(content, folder):
    """Exit code and message for an overlay of the paper's configuration."""
    path = folder / "overlay.yaml"
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    with contextlib.chdir(ROOT):
        return answer(config.main, ["check", PAPER, str(path)])


def answer_to_command(text, files, folder):
    """Exit code and message for a command line, with the names of files and the folder filled in."""
    for name, path in {**files, "folder": str(folder)}.items():
        text = text.replace(f"{{{name}}}", path)
    return answer(cli.main, [part for part in text.split(" ") if part])

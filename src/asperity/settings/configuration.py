"""Settings of the study: a class for each section of its configuration.

A setting that may be left out, without a constant as its default, is None then; an explicit null is refused.
"""

import re
from collections.abc import Iterator
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field, Strict

from asperity.core.errors import shown
from asperity.core.packages import ENGINES, absent
from asperity.settings.map import FileOptions
from asperity.settings.model import (
    DISTINCT,
    NeededError,
    Number,
    OneOf,
    Settings,
    Text,
    Whole,
    YesNo,
    number,
    optional,
    setting,
)
from asperity.settings.quantities import Written
from asperity.settings.sections import LOAD_LABELS

TWO_NODES_SLACK = 1e-9
"""Amount by which a grid may miss two nodes on the shortest wavelength: 1/3 has no finite decimals."""

NAME = r"^(?!(con|prn|aux|nul|com[0-9]|lpt[0-9])\Z)[a-z][a-z0-9_]{0,39}\Z"
"""Pattern of names that the user chooses, without names of devices on Windows."""

NAMES = "a name of at most 40 lower-case letters, digits and underscores that begins with a letter"

_OTHER_LOAD = "another load is given"
_OWN_STUDY = "Surfaces of a study of your own; `[]` for none, as with every study."
_OTHER_HEIGHTS = "another distribution is given"


def _label(text: str) -> str:
    """A text, if a figure can show it; `NeededError` otherwise."""
    if not text.isprintable():
        raise NeededError("text that can be printed")
    if text.count("$") % 2:
        raise NeededError("mathematics between two dollar signs")
    if "$" in text and not absent(["matplotlib"]):
        from matplotlib.mathtext import MathTextParser  # takes time, and not every command has matplotlib

        try:
            MathTextParser("path").parse(text)
        except ValueError:
            raise NeededError("mathematics that matplotlib can draw") from None
    return text


Name = Annotated[Text, Field(pattern=NAME)]
Label = Annotated[Text, Field(min_length=1, max_length=60), AfterValidator(_label)]
Fraction = Annotated[Number, Field(gt=0, le=1)]
Poisson = Annotated[Number, Field(gt=-1, le=0.5)]
Seed = Annotated[Whole, Field(ge=0, le=2**32 - 1)]
Wavelength = Annotated[Number, Field(ge=2 / 32768, le=1)]  # two grid spacings of the finest grid
Nodes = Annotated[Whole, Field(ge=8, le=32768)]
Solver = Literal["gfmd", "active_set"]
LengthOrCells = Annotated[Number, Field(gt=0), Written("length", "8 um")]
Names = Annotated[list[Text], Strict(), Field(min_length=0, max_length=4), DISTINCT]

_AREA_FRACTION = "Real over nominal contact area. Exactly one load is given."
_MEAN_PRESSURE: Any = optional(
    _OTHER_LOAD,
    "Load over the nominal area.",
    unit="effective modulus",
    gt=0,
    le=1000,
)
_NORMAL_APPROACH: Any = optional(
    _OTHER_LOAD,
    "Normal approach since first contact (δ − min h, docs/glossary.md).",
    unit="cell length",
)
_LABEL: Any = setting(..., "Name of the surface in figures; mathematics stands between dollar signs.")
_LOAD: Any = optional("as in section `contact`")


class Load(OneOf):
    """Load of this surface alone, given as one of the loads of section `contact`."""

    contact_area_fraction: Fraction = optional(_OTHER_LOAD, _AREA_FRACTION)
    mean_pressure: Number = _MEAN_PRESSURE
    normal_approach: Fraction = _NORMAL_APPROACH


class Johnson(Settings):
    """Johnson's bounded transform of the Gaussian heights (Eq. 23 of the paper)."""

    gamma: Number = setting(..., ge=-10, le=10)
    """γ, sign and size of the asymmetry. Positive values make blunt contacts."""
    delta: Annotated[Number, Field(gt=0, le=100)] = setting(...)
    """δ, shape; smaller values make the heights more skewed."""
    zeta: Annotated[Number, Field(ge=-100, le=100)] = setting(...)
    """ζ, lower bound of the transformed heights before scaling to `rms_height`."""
    lam: Number = setting(..., gt=0, le=200)
    """λ, width of the interval of the transformed heights before scaling."""


class Moments(Settings):
    """Skewness and kurtosis of a Johnson curve."""

    skewness: Number = setting(..., ge=-5, le=5)
    """Skewness of the transformed heights. Positive values make blunt contacts."""
    kurtosis: Annotated[Number, Field(gt=1, le=100)] = setting(...)
    """Kurtosis of the transformed heights (3 for a Gaussian), larger than 1 + skewness²."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        least = 1 + self.skewness**2
        if self.kurtosis <= least:
            needed = f"a number > {number(least)}, 1 + skewness², is needed"
            yield "kurtosis", f" = {number(self.kurtosis)}: {needed}"


class Plateau(Settings):
    """Heights of a honed surface (ISO 13565-3): a Gaussian plateau, Gaussian valleys, and the material ratio
    at which one passes into the other. Only the ratio of the two roughnesses matters.
    """

    rpq: Number = setting(..., gt=0, le=1000)
    """Root-mean-square roughness Rpq of the plateau."""
    rvq: Annotated[Number, Field(gt=0, le=1000)] = setting(...)
    """Root-mean-square roughness Rvq of the valleys, in the unit of `rpq`."""
    rmq: Number = setting(..., gt=0, lt=100)
    """Material ratio Rmq in per cent."""


class MapFile(FileOptions):
    """Measured height map whose distribution of heights is used, after its trend is subtracted."""

    # Snakemake takes braces in the name of an input for wildcards.
    file: Text = setting(
        ..., pattern=r"^[^{}]{1,1000}\Z", accepts="a file name without braces of at most 1000 characters"
    )
    """File of the height map, peaks upward, in a format of `docs/formats.md`."""


class Heights(OneOf):
    """Distribution of the heights. The surface keeps the spectrum, rms height and rms gradient of the
    Gaussian surface. Excludes `johnson` and `moments`, which change the spectrum.
    """

    moments: Moments = optional(_OTHER_HEIGHTS)
    plateau: Plateau = optional(_OTHER_HEIGHTS)
    map: MapFile = optional(_OTHER_HEIGHTS)


class Surface(Settings):
    """A random rough surface."""

    label: Label = _LABEL
    hurst: Annotated[Number, Field(ge=0, le=1)] = setting(...)
    """Hurst exponent."""
    wavelength_long: Wavelength = setting(..., unit="cell length")
    """Longest wavelength of the spectrum."""
    wavelength_short: Wavelength = setting(..., unit="cell length")
    """Shortest wavelength of the spectrum; at least two grid spacings."""
    rms_height: Fraction = setting(..., unit="cell length")
    """Root-mean-square height."""
    points: Nodes = optional("the preset's number for each `wavelength_short`")
    """Nodes of the grid on each edge of the cell."""
    contact: Load = _LOAD
    johnson: Johnson = optional("no transform")
    moments: Moments = optional("no transform")
    """Johnson's transform of the Gaussian heights to a given skewness and kurtosis. Excludes `johnson`."""
    heights: Heights = optional("Gaussian")

    def contradictions(self) -> Iterator[tuple[str, str]]:
        short, long, points = number(self.wavelength_short), number(self.wavelength_long), self.points
        if self.wavelength_short > self.wavelength_long:
            yield "wavelength_short", f" = {short}: at most wavelength_long = {long} is needed"
        if points and self.wavelength_short * points < 2 - TWO_NODES_SLACK:
            fewest = f"at least {round(2 / self.wavelength_short)} are needed"
            yield "points", f" = {points}: {fewest}, two on wavelength_short = {short}"
        given = [kind for kind in ("johnson", "moments", "heights") if getattr(self, kind)]
        if len(given) > 1:
            yield given[1], f": only one of {given[1]} and {given[0]} is accepted"


class MeasuredMap(MapFile):
    """A measured height map."""

    label: Label = _LABEL
    contact: Load = _LOAD
    periodic: Literal["declared", "mirrored", "windowed"] = optional(
        "a file that states a period is required"
    )
    """As `map.periodic` of a case, without a free boundary."""
    undefined: Literal["harmonic"] = optional("such maps are refused")
    """How non-measured points are filled."""
    wavelength_short: Annotated[Wavelength, Written("length", "8 um")] = optional(
        "two pixels of the map", unit="cell length, unless it has its own"
    )
    """Short-wavelength cut-off, in whose unit figures show depths; a number is in cell lengths, of which a
    mirrored map fills half."""
    s_filter: LengthOrCells = optional("no filter", unit="cell length, unless it has its own")
    """As in a case."""
    l_filter: LengthOrCells = optional("no filter", unit="cell length, unless it has its own")
    """As in a case."""
    points: Nodes = optional(
        "the preset's number for each `wavelength_short` in cell lengths; without it, as in the map"
    )
    """Nodes on the longer edge of the cell; an even number for a mirrored map."""


class Studies(Settings):
    """Names of surfaces that figures compare; only they are computed. The names in this table are the
    paper's studies, whose figures are drawn with `figures` set to `paper`.
    """

    model_config = ConfigDict(
        extra="allow",
        json_schema_extra={"names": NAMES, "propertyNames": {"type": "string", "pattern": NAME}},
    )
    __pydantic_extra__: dict[str, Annotated[Names, Field(description=_OWN_STUDY)]]

    hurst: Names = optional("none")
    """Surfaces of figures 6 to 11."""
    compressibility: Annotated[list[Text], Strict(), Field(min_length=0, max_length=1), DISTINCT] = optional(
        "none"
    )
    """Surface of figures 13 to 15, at the Poisson's ratios of `stress.poisson`."""
    skewness: Names = optional("none")
    """Surfaces of figures 16a and 17a."""
    kurtosis: Names = optional("none")
    """Surfaces of figures 16b, 17b and 18."""
    moments: Names = optional("none")
    """Surfaces of the supplement that differ in the kurtosis of their heights."""
    measured: Names = optional("none")
    """Surfaces of the supplement on measured surfaces."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        for name in self.__pydantic_extra__:
            if not re.match(NAME, name):
                yield shown(name), f": {NAMES} is needed"


class Base(Settings):
    """Elastic half-space to which the layer is bonded, so that the layer is a coating."""

    modulus_ratio: Number = setting(..., ge=1e-6, le=1e6)
    """Young's modulus of the base over Young's modulus of the layer."""
    poisson: Poisson = setting(...)
    """Poisson's ratio of the base."""


class Layer(Settings):
    """The elastic solid."""

    height: Number = setting(1.0, unit="cell length", gt=0, le=1000)
    """Height of the layer."""
    bottom: Literal["bonded", "frictionless"] = setting("bonded")
    """Lower face of the layer: `bonded` to a rigid base, or on a `frictionless` one."""
    poisson: Poisson = setting(0.33)
    """Poisson's ratio of the contact, and of figures that show only one."""
    base: Base = optional("a rigid base")
    lateral: Literal["confined", "free"] = setting("confined")
    """Lateral state under the mean pressure: `confined` (no lateral strain) or `free` (no mean lateral
    stress)."""
    half_space_tolerance: Number = optional("preset", ge=0, le=1)
    """Maximum difference between layer and half-space, relative to the pressure of a mode, at which the
    half-space replaces the layer."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        if self.base and self.bottom != "bonded":
            yield "bottom", f" = {self.bottom!r}: bonded is needed with layer.base"


class Contact(Settings):
    """The contact problem. A list in place of a load, such as `contact_area_fraction: [0.02, 0.1]`, presses
    every surface `NAME` under each load, as `NAME_load1`, `NAME_load2` and so on.
    """

    method: Solver = setting("active_set")
    """Solver: damped dynamics as in the paper (`gfmd`), or the faster `active_set` with the same result."""
    contact_area_fraction: Fraction = setting(0.1, _AREA_FRACTION)
    mean_pressure: Number = _MEAN_PRESSURE
    normal_approach: Fraction = _NORMAL_APPROACH
    hardness: Annotated[Number, Field(gt=0, le=1000)] = optional("an elastic contact")
    """Maximum pressure of a plastic contact, in effective moduli E*."""
    path_contact_area_fractions: Annotated[list[Fraction], Strict(), Field(min_length=1), DISTINCT] = (
        optional("the imposed load alone")
    )
    """Area fractions of the load-area curve."""
    tolerance: Annotated[Number, Field(ge=1e-14, le=1e-2)] = optional("preset")
    """Estimated error of the pressure, relative to its norm."""
    precision: Literal["float64", "float32"] = optional("preset")
    """Floating-point precision of the contact problem."""

    def contradictions(self) -> Iterator[tuple[str, str]]:
        loads = [name for name in LOAD_LABELS if name in self.model_fields_set]
        if len(loads) > 1:
            together = f"not accepted together with {loads[0]}; one of {', '.join(LOAD_LABELS)} is needed"
            yield loads[1], f" = {number(getattr(self, loads[1]))}: {together}"
        if self.method == "gfmd" and self.hardness:
            yield "hardness", f" = {number(self.hardness)}: no value with method gfmd is needed"
        for choice, least in {
            "method gfmd": 1e-13,  # the damped dynamics stop at 1.5e-14, by rounding
            "precision float32": 1e-6,  # smaller residuals are rounding errors in single precision
        }.items():
            chosen = choice in (f"method {self.method}", f"precision {self.precision}")
            if chosen and self.tolerance and self.tolerance < least:
                needed = f"a number ≥ {number(least)} with {choice} is needed"
                yield "tolerance", f" = {number(self.tolerance)}: {needed}"


class Stress(Settings):
    """The stress inside the solid."""

    poisson: Annotated[list[Poisson], Strict(), Field(min_length=1, max_length=16), DISTINCT] = optional(
        "as in the contact"
    )
    """Poisson's ratios at which the stress is analysed; of the paper's surfaces, only for study
    `compressibility`."""
    tolerance: Number = optional("preset", ge=0, le=0.1)
    """Maximum error by a coarser grid in a deep plane, relative to the rms of σ_zz there; 0 for the full grid
    at every depth."""
    depth_spacing: Number = optional("preset", unit="grid spacings", ge=0.05, le=4)
    """Distance between planes near the surface; at depth a quarter of this number times the depth."""


class Statistics(Settings):
    """Distributions over the seeds, and their uncertainty."""

    bins: Annotated[Whole, Field(ge=2, le=10_000)] = setting(100)
    """Number of bins of every probability density. Densities of peaks have fewer bins where an average bin
    would hold less than twenty peaks."""
    resamples: Annotated[Whole, Field(ge=10, le=100_000)] = setting(1000)
    """Bootstrap resamples over the seeds. Confidence bands need at least two seeds."""
    confidence: Number = setting(0.95, gt=0, lt=1)
    """Confidence level of the bands."""


def _nodes(least: int, most: int = 4096, of: str = "grid") -> Any:
    """Setting: nodes of a grid or map on each edge."""
    return setting(..., f"Nodes of the {of} on each edge.", ge=least, le=most)


class LoadArea(Settings):
    """Contact area against load of a periodic paraboloid (figure 2a)."""

    points: Whole = _nodes(32)
    method: Solver = setting(...)
    """Solver, as in `contact.method`."""


class SlabLoadArea(Settings):
    """Slabs of several heights, indented to the depth of the paper (figures 2b and 2c)."""

    points: Whole = _nodes(64)
    method: Solver = setting(...)
    """Solver, as in `contact.method`."""
    steps: Whole = setting(..., ge=2, le=100)
    """Steps of the indentation."""


class GridConvergence(Settings):
    """Errors on finer and finer grids, where the solution is known (figure 2d)."""

    points: Annotated[
        list[Annotated[Whole, Field(ge=16, le=2048)]], Strict(), Field(min_length=2), DISTINCT
    ] = setting(...)
    """Nodes of the grids on each edge, in rising order."""


class Elements(Settings):
    """Displacement and stress in the diagonal plane of the indented slab, compared with finite elements
    (figures 1, 3 and 4).
    """

    meshes: Annotated[
        list[
            Annotated[list[Annotated[Whole, Field(ge=4, le=96)]], Strict(), Field(min_length=2, max_length=2)]
        ],
        Strict(),
        Field(min_length=2),
    ] = setting(...)
    """Meshes, coarse to fine, each as hexahedra along half an edge of the cell and along its height."""
    points: Whole = _nodes(32, 2048)


class Punch(Settings):
    """Von Mises stress under a Hertzian contact (figure 12)."""

    points: Whole = _nodes(64)
    samples: Whole = setting(..., ge=11, le=1001)
    """Depths of the plane that is drawn."""


class EllipticContacts(Settings):
    """Elliptic contacts on an isolated map, pressure and stress on the axis."""

    points: Whole = _nodes(32, 2048, "map")


class OnMap(Settings):
    """A comparison on a map."""

    points: Whole = _nodes(32, of="map")


class OnGrid(Settings):
    """A comparison on a grid."""

    points: Whole = _nodes(128)


class Validation(Settings):
    """Comparisons with closed forms, finite elements and high precision. A comparison that is left out is not
    made.
    """

    load_area: LoadArea = optional("not made")
    slab_load_area: SlabLoadArea = optional("not made")
    grid_convergence: GridConvergence = optional("not made")
    elements: Elements = optional("not made")
    punch: Punch = optional("not made")
    elliptic_contacts: EllipticContacts = optional("not made")
    edge_tension: OnMap = optional("not made")
    """Radial stress of the surface outside a circular contact on an isolated map."""
    metal_contacts: OnMap = optional("not made")
    """Hardness, stiffness, partial slip, percolation and stress cycles of a map, a sphere, noise and a
    cylinder."""
    layer_indentation: OnGrid = optional("not made")
    """Bonded layers under a flat punch and a paraboloid."""
    coating_indentation: OnGrid = optional("not made")
    """A paraboloid on coated half-spaces."""
    wave_asymptotes: OnGrid = optional("not made")
    """A bisinusoidal wave in small and in nearly complete contact."""


class Configuration(Settings):
    """Lengths are in units of the longer edge of the periodic cell, stresses in units of the effective
    modulus.
    """

    based_on: Text = optional("nothing", accepts="the name of a configuration, such as `config/config.yaml`")
    """Another configuration, whose settings, except `results`, hold where this file gives none; it may be
    based on a third."""
    results: Text = optional(
        "`results/NAME` for a file `NAME.yaml`",
        pattern=r"^results(/[A-Za-z0-9_-]{1,60}){0,8}\Z",
        accepts="`results` or a folder below it",
    )
    """Folder for all results, inside the project; `--config results=FOLDER` of the command line takes any
    folder."""
    accuracy: Literal["draft", "paper", "reference"] = setting("paper")
    """Preset of all settings of accuracy; an explicit value overrides it."""
    fft_engine: Literal[ENGINES] = setting(ENGINES[0])  # type: ignore[valid-type]
    """Library of the Fourier transforms: `ducc0`, `pyfftw` (extra `fftw`) or `scipy` (BSD licence). Results
    differ by rounding errors."""
    seeds: Annotated[list[Seed], Strict(), Field(min_length=1), DISTINCT] = optional(
        "1, 2, … up to the number of the preset"
    )
    """Realisations of the random surfaces; every surface is computed once per seed."""
    figures: Literal["own", "paper"] = setting("own")
    """`own` draws the same figures for each study. `paper` draws the numbered figures of the paper and its
    supplement for the studies in table `studies`, and `own` for others."""
    claims: YesNo = setting(False)
    """Compare the statements of the paper with the results; requires `figures: paper`."""
    surfaces: dict[Name, Surface] = setting({}, names=NAMES)
    """Random rough surfaces, each under a name of lower-case letters, digits and underscores."""
    measured: dict[Name, MeasuredMap] = setting({}, names=NAMES)
    """Measured height maps, each under a name as in `surfaces`."""
    studies: Studies = optional("one study of all surfaces, `all`")
    layer: Layer = setting({})
    contact: Contact = setting({})
    stress: Stress = setting({})
    statistics: Statistics = setting({})
    validation: Validation = setting({})

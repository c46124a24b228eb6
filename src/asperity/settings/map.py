"""Settings of a height map: properties that its file does not state, and its treatment."""

import os
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Annotated, Any, Literal

from pydantic import (
    PlainSerializer,
    PlainValidator,
    TypeAdapter,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)

from asperity.settings.model import NeededError, Number, Settings, Whole, optional, setting
from asperity.settings.quantities import LengthOrNumber, Position

MOST_POINTS = 2**16
"""Most nodes on the longer edge of a map that is resampled: 34 GB."""


Detrend = Literal["none", "tilt", "curvature"]
"""Trends that can be removed, of the degrees 0, 1 and 2."""

Periodicity = Literal["declared", "mirrored", "windowed", "none"]
"""Ways in which a map is made periodic; with ``none`` it is not, for a contact with a free boundary."""


def file_name(value: Any) -> str:
    """The name of a file as text; `NeededError` if no file can have it."""
    name = os.fspath(value) if isinstance(value, (str, os.PathLike)) else ""
    with suppress(UnicodeEncodeError):  # of surrogates that stand for no bytes
        if isinstance(name, str) and name and b"\0" not in os.fsencode(name):
            return name
    raise NeededError("the name of a file")


def _source(value: Any) -> Any:
    """The name of a file as text, or a map in memory, which has heights and edges."""
    if hasattr(value, "height") and hasattr(value, "length"):
        return value
    if hasattr(value, "ndim"):
        raise NeededError("an asperity.HeightMap or, in asperity.run, an array beside its length")
    return file_name(value)


def with_file(value: Any) -> Any:
    """The group of a map, for which the name of its file alone, or names in a list, may stand."""
    return value if value is None or isinstance(value, (Mapping, Settings)) else {"file": value}


Source = Annotated[
    Any,
    PlainValidator(_source),
    PlainSerializer(lambda source: source if isinstance(source, str) else source.name or "map"),
    WithJsonSchema(
        {
            "anyOf": [{"type": "string", "format": "path"}, {"type": "array", "items": {"type": "string"}}],
            "accepts": "the name of a file",  # a case file of several maps has a list
        }
    ),
]
"""File of a map, or in Python a `asperity.HeightMap`."""


CROP = "one length with its unit such as 150 um, two (y, x), or fit in a Hertz contact"


def _crop(value: Any, info: ValidationInfo) -> Any:
    """One or two edges, which stay as they are written, or ``fit``."""
    if value == "fit":
        return value
    edges = value.split(",") if isinstance(value, str) else value
    edges = edges if isinstance(edges, (list, tuple)) else [edges]
    check = TypeAdapter(LengthOrNumber, config=Settings.model_config)
    try:
        one, *more = [check.validate_python(each, context=info.context) for each in edges]
    except ValueError:
        raise NeededError(CROP) from None
    if len(more) > 1:
        raise NeededError(CROP)
    return (one, *more) if more else one


Crop = Annotated[
    Any,
    PlainValidator(_crop),
    WithJsonSchema(
        {
            "anyOf": [{"type": "number"}, {"type": "array"}, {"type": "string", "format": "length"}],
            "accepts": CROP,
        }
    ),
]
"""Edge of a square part of a map, or edges (y, x), or ``fit``."""


class FileOptions(Settings):
    """Properties of a height map that its file may not state, and a treatment that needs no grid."""

    channel: str | int | None = optional(
        "the channel of heights",
        accepts="a name of at most 200 characters, or a number",
    )
    """Channel of the file."""
    unit: str | None = optional(
        "as in the file",
        pattern="^[A-Za-zµμÅ]{1,20}( [A-Za-zµμÅ]{1,20})?\\Z",
        accepts="a unit of length such as nm, um, mm or m, or two such as mm um",
        example="um",
    )
    """Unit of the heights and of edges given as numbers; for a list of points also two, of x and y, and of
    z."""
    physical_size: tuple[LengthOrNumber, LengthOrNumber] | None = optional(
        "as in the file",
        accepts="two lengths > 0 (y, x) with their units such as 512 um, or numbers > 0",
        example=["200 um", "200 um"],
    )
    """Edges (y, x) of the map. Numbers are in the unit of the heights."""
    height_factor: Number | None = optional("as in the file", gt=0, le=1e12)
    """Factor from the numbers in the file to heights."""
    missing: Number | None = optional("as the format of the file marks them")
    """Number in the file that stands for non-measured points, such as -9999."""
    mask: Literal["excluded"] | None = optional("the mask is reported, not applied")
    """`excluded` makes points that a mask in the file marks non-measured."""
    orientation: Literal["peaks up", "lower face"] | None = optional("as in the file")
    """Direction of the heights, if the file does not state it: `peaks up`, as instruments show them, or
    `lower face` of an indenter, as in the library."""
    format: str | None = optional(
        "recognised from the file", pattern="^[a-z0-9]{1,20}\\Z", accepts="the name of a format"
    )
    """Format of a file that is not recognised (`asperity info --help` lists them). `profile` reads a line
    scan as a map with equal heights along y."""
    max_memory: Number = setting(2.0, unit="GiB", gt=0)
    """Maximum size of the unpacked file."""
    scan_lines: Literal["median", "matched"] | None = optional("offsets are kept")
    """Removes offsets between scan lines along x: the median of each line, or of its differences from the
    line before (`matched`)."""
    despike: Number | None = optional(
        "no point is replaced; 8 keeps every point of a Gaussian surface", ge=3, example=8
    )
    """Replaces points that differ from the local median by more than this number of robust standard
    deviations of the local roughness."""
    detrend: Detrend | None = optional("tilt; none for a map that is one period")
    """Trend that is subtracted besides the mean, by least squares."""


class MapOptions(FileOptions):
    """Properties of a height map, and options of its treatment.

    A property that is given replaces the file's, and the map notes it; for several maps that share options
    the file takes precedence.

    Lengths are numbers in the unit of the map, which is metres if a unit is known, or texts with a unit such
    as ``"8 um"``.

    Raises
    ------
    SettingsError
        With everything that is not accepted.

    Examples
    --------
    For an array of numpy, which contains neither size nor unit nor orientation:

    >>> asp.MapOptions(physical_size=("80 um", "80 um"), unit="nm", orientation="peaks up").unit
    'nm'
    """

    undefined: Literal["harmonic"] | None = optional("such maps are refused; asperity run fills the points")
    """How non-measured points are filled."""
    s_filter: LengthOrNumber | None = optional("no filter", example="2.5 um")
    """Nesting index of the Gaussian S-filter (ISO 16610-61), which attenuates shorter waves."""
    l_filter: LengthOrNumber | None = optional("no filter", example="80 um")
    """Nesting index of the Gaussian L-filter (ISO 16610-61), which attenuates longer waves."""
    periodic: Periodicity | None = optional(
        "declared if the file states a period; asperity run mirrors other maps"
    )
    """`declared`: the map is one period. `mirrored`: mirror images continue it (a cell of twice the edges).
    `windowed`: the outer tenth of each edge falls to the mean plane (doi 10.1109/PROC.1978.10837). `none`:
    nothing surrounds it, a free boundary."""
    ends: Literal["y", "x", "none"] | None = optional(
        "across a cylinder between half-spaces, if the map is mirrored or declared; else none"
    )
    """Axis along which nothing surrounds the map: `x` for a roller whose axis is y, along which the map
    continues. Requires half-spaces."""
    wavelength_short: LengthOrNumber | None = optional("two pixels of the map", example="8 um")
    """Short-wavelength cut-off: shorter waves are removed."""
    points: Whole | None = optional("as in the map", ge=2, le=MOST_POINTS)
    """Nodes on the longer edge of the map, by Fourier interpolation."""
    radius: LengthOrNumber | None = optional("the map alone", example="5 mm")
    """Radius of a sphere or cylinder, whose form is added in the middle of the map; with `radius_y`, along
    x."""
    radius_y: LengthOrNumber | None = optional("the radius along x", example="120 mm")
    """Radius along y of a form with two combined radii, such as a ball in a groove."""
    form: Literal["sphere", "cylinder"] = setting("sphere")
    """Form to which the radius belongs."""
    cylinder_axis: Literal["y", "x"] = setting("y")
    """Direction of the axis of the cylinder."""


class Map(MapOptions):
    """The height map that is pressed, peaks upward as measured."""

    file: Source = setting(..., example="steel.x3p")
    """Height map of an instrument, peaks upward."""
    crop: Crop | None = optional("the whole map", example="150 um")
    """Edge of the square part that is used, or its edges (y, x); a longer edge keeps the whole map. `fit`
    takes the part of a Hertz contact over which the pressure is nearly uniform."""
    crop_at: tuple[LengthOrNumber, LengthOrNumber] | None = optional(
        "the middle of the map",
        accepts="two lengths > 0 (y, x) with their units such as 80 um, or numbers > 0",
        example=["80 um", "120 um"],
    )
    """Middle (y, x) of the part, from the first point of the map."""

    @property
    def free_edges(self) -> tuple[str, str] | None:
        """Setting by which the map ends at edges, and its value."""
        if self.periodic == "none":
            return "map.periodic", "none"
        return None if self.ends in (None, "none") else ("map.ends", str(self.ends))

    def contradictions(self) -> Iterator[tuple[str, str]]:
        """A place without a part."""
        if self.crop_at is not None and self.crop is None:
            yield "crop_at", ": needs crop"

    @model_validator(mode="before")
    @classmethod
    def _of_file(cls, value: Any) -> Any:
        return with_file(value)


class CounterMap(Map):
    """Height map of the counter body, peaks upward as measured.

    It is turned over and laid on the map, middle on middle. Options that it does not give are taken from the
    map; filters, `points`, `ends` and the form are given for the map alone and hold for both.
    """

    turned_about: Literal["y", "x"] = setting("y")
    """Axis about which the counter map is turned over, to face down."""
    shift: tuple[Position, Position] = setting(
        (0.0, 0.0),
        accepts="two lengths (y, x) with their units, such as 10 um and -4 um",
        example=["10 um", "-4 um"],
    )
    """Position (y, x) of the middle of the counter map, from the middle of the map."""

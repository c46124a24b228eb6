"""Classes of settings: the statements of a field, and the messages on values that it does not accept.

`pydantic` validates; this module adds further statements to a field, makes one line of each problem, and
describes a class as a JSON Schema with these keywords of its own: ``unit``; ``default_text``, the behaviour
without the setting, where it has no constant default; ``accepts``, the accepted values in words, where type
and range are not enough; ``example``, a value as a user writes it; and of a group ``names``, the accepted
names of settings that the user names; and ``varied``, true for a number that a sensitivity varies.
"""

import ast
import copy
import inspect
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from contextvars import ContextVar
from functools import cache
from itertools import pairwise
from numbers import Real
from typing import TYPE_CHECKING, Annotated, Any, Self, get_args

from pydantic import (
    BaseModel,
    ConfigDict,
    Field,
    GetPydanticSchema,
    PlainValidator,
    Strict,
    TypeAdapter,
    ValidationError,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import PydanticCustomError, core_schema

from asperity.core.errors import InputError, Problem, did_you_mean, shown
from asperity.core.units import misread

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass as _Metaclass
else:
    _Metaclass = type(BaseModel)

Entry = Mapping[str, Any]
"""Description of one setting, or of a group of settings, in the words of a JSON Schema."""

OWN_KEYWORDS = {"unit", "default_text", "accepts", "example", "names", "varied"}
"""Keywords of an entry that the standard does not have."""

Number = Annotated[float, Strict()]
"""A number; text and truth values are refused."""

Whole = Annotated[int, Strict()]
"""A whole number that is written as one: 2048.0 is refused."""

YesNo = Annotated[bool, Strict()]

Text = Annotated[str, Strict()]


def _distinct(items: list[Any]) -> list[Any]:
    if len(set(items)) < len(items):
        raise PydanticCustomError("distinct", "distinct items are needed")
    return items


DISTINCT = GetPydanticSchema(
    lambda source, handler: core_schema.no_info_after_validator_function(_distinct, handler(source)),
    lambda schema, handler: handler(schema) | {"uniqueItems": True},
)
"""Mark of a list that has no item twice, after the marks of its length."""

_LONGEST_KEY = 40
"""Characters of a key that are shown as they are; longer keys are shortened like values."""

_TYPES = {
    "number": "a number",
    "integer": "a whole number",
    "string": "text",
    "boolean": "true or false",
    "array": "a list",
    "object": "a group of keys",
}


class SettingsError(InputError):
    """Raised for settings that are not accepted, with all of their problems.

    Examples
    --------
    >>> try:
    ...     asp.Body(young="210 GPa", poisson=0.7)
    ... except asp.SettingsError as error:
    ...     print(error)
    poisson = 0.7: a number > -1 and ≤ 0.5 is needed
    """


class NeededError(ValueError):
    """Raised by a check of one value; the message says what is needed instead."""


class _ProblemsOfAll(_Metaclass):
    """Metaclass of `Settings`: its errors in place of those of `pydantic`, and help on every setting."""

    def __call__(cls: Any, **given: Any) -> Any:  # noqa: N805  of a metaclass
        try:
            return super().__call__(**given)
        except ValidationError as error:
            raise SettingsError("", problems(cls, error)) from None

    @property
    def __doc__(cls: Any) -> str | None:  # type: ignore[override]  # noqa: N805
        """The docstring with a list of all settings, which is made when it is read."""
        text = cls.__dict__.get("__doc__")
        return text if text is None or _DESCRIBING.get() else _with_settings(inspect.cleandoc(text), cls)

    @property
    def __signature__(cls: Any) -> inspect.Signature:  # noqa: N805
        """The settings as keywords with their defaults; None also for one that another setting may give."""
        required = {
            name
            for name, field in cls.model_fields.items()
            if field.is_required() and "default_text" not in (field.json_schema_extra or {})
        }
        parameters = [
            inspect.Parameter(
                name,
                inspect.Parameter.KEYWORD_ONLY,
                default=inspect.Parameter.empty if name in required else field.get_default(),
            )
            for name, field in cls.model_fields.items()
        ]
        return inspect.Signature(parameters)

    @__signature__.setter
    def __signature__(cls, given: Any) -> None:  # noqa: N805
        """`pydantic` sets one with its internals, which is not kept."""


_DESCRIBING = ContextVar("describing", default=False)
"""True while `pydantic` describes a class, for which it reads docstrings."""


def _with_settings(text: str, cls: type[BaseModel]) -> str:
    """A docstring with all settings of its class as parameters."""
    entry = described(cls)
    lines = ["Parameters", "----------"]
    for name, below in entry["properties"].items():
        unit = f", in {below['unit']}" if "unit" in below else ""
        left_out = below.get("default_text") or below.get("default")
        default = "" if name in entry.get("required", ()) else f" Default: {left_out}."
        lines += [f"{name} : {accepted(below)}{unit}", f"    {below.get('description', '')}{default}"]
    head, mark, rest = text.partition("Raises\n------")
    return "\n".join([head.rstrip(), "", *lines, "", mark + rest])


class Settings(BaseModel, metaclass=_ProblemsOfAll):
    """A group of settings that stay as they are; unknown keys are refused.

    Raises
    ------
    SettingsError
        With all values that are not accepted, and keys that are unknown or missing.
    """

    model_config = ConfigDict(
        defer_build=True,
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        arbitrary_types_allowed=True,
        regex_engine="python-re",
        protected_namespaces=(),
    )

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: Any) -> dict[str, Any]:
        """Description of the class, with the texts of its settings."""
        entry = handler(core_schema)
        properties = handler.resolve_ref_schema(entry)["properties"]
        for name, text in _texts_of(cls).items():
            if name in properties:
                properties[name]["description"] = text
        return entry

    @classmethod
    def read(cls, values: Mapping[str, Any], source: str = "", **context: Any) -> Self:
        """The settings in a file or on the command line, where quantities have their units.

        Parameters
        ----------
        values : mapping
        source : str
            File of the values, for messages.
        **context
            Passed to the checks of the fields.
        """
        try:
            return cls.model_validate(values, context={"units": True} | context)
        except ValidationError as error:
            raise SettingsError(source, problems(cls, error)) from None

    def contradictions(self) -> Iterator[tuple[str, str]]:
        """Key and rest of the message of settings of the group that exclude each other."""
        yield from ()

    @model_validator(mode="before")
    @classmethod
    def _plain(cls, values: Any) -> Any:
        """The values, with numbers of NumPy as numbers of Python."""
        if not isinstance(values, dict):
            return values
        return {name: _plain_numbers(each) for name, each in values.items()}

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        if found := tuple(self.contradictions()):
            raise SettingsError("", found)
        return self

    def replaced(self, **changes: Any) -> Self:
        """The settings with other values of some of them."""
        return type(self)(**{name: getattr(self, name) for name in self.model_fields_set} | changes)

    def written(self) -> dict[str, Any]:
        """The settings that are given, as a file holds them, with their units."""
        return self.model_dump(mode="json", exclude_unset=True, exclude_none=True)


def _plain_numbers(value: Any) -> Any:
    """A number of NumPy as one of Python, also in a list."""
    if isinstance(value, (list, tuple)):
        return [_plain_numbers(each) for each in value]
    return value.item() if isinstance(value, Real) and hasattr(value, "item") else value


def _one_of(schema: dict[str, Any]) -> None:
    """Add to the description of a group that one of its settings is accepted."""
    *names, last = schema["properties"]
    schema |= {"minProperties": 1, "maxProperties": 1, "accepts": f"one of {', '.join(names)} and {last}"}


class OneOf(Settings):
    """A group of which exactly one setting is given."""

    model_config = ConfigDict(json_schema_extra=_one_of)

    @model_validator(mode="after")
    def _one(self) -> Self:
        if len(self.model_fields_set) != 1:
            raise NeededError(accepted(described(type(self))))
        return self


def setting(
    default: Any,
    text: str | None = None,
    *,
    unit: str | None = None,
    default_text: str | None = None,
    accepts: str | None = None,
    example: Any = None,
    names: str | None = None,
    varied: bool | None = None,
    **limits: Any,
) -> Any:
    """A field of a class of settings.

    Parameters
    ----------
    default : any
        ``...`` for a setting that has to be given, and ``{}`` for a group of which each setting may be left
        out; `optional` makes one that has no constant as its default.
    text : str, optional
        Meaning of the setting; by default the docstring below the field, else of the class of a group.
    unit, default_text, accepts, example, names, varied : optional
        Keywords of the description, see the head of this module.
    **limits
        Of `pydantic.Field`: ``ge``, ``gt``, ``le``, ``lt``, ``min_length``, ``max_length``, ``pattern``.
    """
    own = {"unit": unit, "default_text": default_text, "accepts": accepts, "example": example, "names": names}
    extra = {name: value for name, value in {**own, "varied": varied}.items() if value is not None}
    filled = isinstance(default, dict)
    return Field(default, description=text, json_schema_extra=extra, validate_default=filled, **limits)


def optional(default_text: str, text: str | None = None, **more: Any) -> Any:
    """A field that may be left out, with `default_text` for this case; the rest is as in `setting`."""
    return setting(None, text, default_text=default_text, **more)


@cache
def _texts_of(cls: type[BaseModel]) -> dict[str, str]:
    """Setting → its text, the docstring below the field, of a class and those that it extends."""
    texts: dict[str, str] = {}
    for each in reversed([each for each in cls.__mro__ if issubclass(each, BaseModel)]):
        body = _classes_in(each.__module__).get(each.__name__, [])
        for field, below in pairwise(body):
            if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name):
                text = getattr(getattr(below, "value", None), "value", None)
                if isinstance(below, ast.Expr) and isinstance(text, str):
                    texts[field.target.id] = text
    return texts


@cache
def _classes_in(module: str) -> dict[str, list[ast.stmt]]:
    """Class → its statements, of the source of a module."""
    tree = ast.parse(inspect.getsource(sys.modules[module]))
    return {node.name: node.body for node in tree.body if isinstance(node, ast.ClassDef)}


@cache
def described(cls: type[BaseModel]) -> Entry:
    """Description of a class of settings and of the groups in it."""
    token = _DESCRIBING.set(True)
    try:
        schema = cls.model_json_schema()
    finally:
        _DESCRIBING.reset(token)
    return _plain(schema, schema.get("$defs", {}))


def _plain(entry: Any, known: Mapping[str, Any]) -> Any:
    """An entry of a JSON Schema with references filled in, and without titles and null."""
    if not isinstance(entry, dict):
        return [_plain(each, known) for each in entry] if isinstance(entry, list) else entry
    entry = dict(entry)
    if "$ref" in entry:
        entry = known[entry.pop("$ref").rpartition("/")[2]] | entry
    if "anyOf" in entry:
        others = [_plain(each, known) for each in entry.pop("anyOf") if each.get("type") != "null"]
        entry = (others[0] if len(others) == 1 else {"anyOf": others}) | entry
    if entry.get("default", 0) in (None, []):
        del entry["default"]
    if "patternProperties" in entry:
        ((pattern, below),) = entry.pop("patternProperties").items()
        entry |= {"additionalProperties": below, "propertyNames": {"type": "string", "pattern": pattern}}
    if isinstance(entry.get("description"), str):
        entry["description"] = " ".join(entry["description"].split("\n\n")[0].split())
    kept = {}
    for key, value in entry.items():
        if key == "properties":
            kept[key] = {name: _plain(below, known) for name, below in value.items()}
        elif key not in ("$defs", "title"):
            kept[key] = copy.deepcopy(value) if key == "default" else _plain(value, known)
    return kept


def nested(cls: type[BaseModel], value: Any, info: ValidationInfo) -> Any:
    """A group that the check of another setting makes; its problems have keys inside the group."""
    try:
        return cls.model_validate(value, context=info.context)
    except ValidationError as error:
        raise SettingsError("", problems(cls, error)) from None


def value_at(settings: Any, key: str) -> Any:
    """The setting of a dotted key, in which a number is a place in a list; None if a group is not given."""
    for part in key.split("."):
        if isinstance(settings, tuple):
            settings = settings[int(part)] if part.isdecimal() and int(part) < len(settings) else None
        else:
            settings = getattr(settings, part, None)
    return settings


def with_value(settings: Any, key: str, value: Any) -> Any:
    """The settings with another value of a dotted key."""
    name, _, rest = key.partition(".")
    if isinstance(settings, tuple):
        changed = value if not rest else with_value(settings[int(name)], rest, value)
        return (*settings[: int(name)], changed, *settings[int(name) + 1 :])
    return settings.replaced(**{name: with_value(getattr(settings, name), rest, value) if rest else value})


def entry_of(root: type[BaseModel], key: str) -> Entry:
    """Description of one setting, by its dotted key; ``NAME`` stands for a name that the user chooses."""
    *groups, name = key.split(".")
    try:
        entry = described(_class_of(root, groups))  # without the other groups, whose description takes time
        return entry["additionalProperties"] if name == "NAME" else entry["properties"][name]
    except (AttributeError, KeyError):  # below a list
        entry = described(root)
        for part in key.split("."):
            entry = inside(entry, part) or {}
        return entry


def _class_of(root: Any, groups: Iterable[str]) -> Any:
    """Class of a group, or of one item of a group, by the parts of its dotted key."""
    for part in groups:
        cls = _without_none(root)
        root = get_args(cls)[1] if part == "NAME" else cls.model_fields[part].annotation
    return _without_none(root)


def entries(entry: Entry, prefix: str = "") -> Iterator[tuple[str, Entry]]:
    """Dotted key and description of every group and setting below an entry, in their order."""
    for name, below in entry.get("properties", {}).items():
        yield f"{prefix}{name}", below
        yield from entries(below, f"{prefix}{name}.")
        if "properties" in (item := item_of(below)) and item is not below:
            yield from entries(item, f"{prefix}{name}.0.")
    if isinstance(named := entry.get("additionalProperties"), Mapping):
        yield from entries(named, f"{prefix}NAME.")


def accepted(entry: Entry) -> str:
    """Accepted values of a setting in words, such as "a number > 0 and ≤ 1"."""
    if "accepts" in entry:
        return entry["accepts"]
    if "enum" in entry or "const" in entry:
        return " or ".join(map(str, entry.get("enum", [entry.get("const")])))
    if "anyOf" in entry:
        return ", or ".join(accepted(each) for each in entry["anyOf"])
    if entry["type"] == "array":
        fewest, most = entry.get("minItems", 0), entry.get("maxItems")
        count = f"≥ {fewest}" if most is None else f"{most}" if fewest == most else f"{fewest} to {most}"
        items = f"{count} {'distinct ' if entry.get('uniqueItems') else ''}items" if most != 1 else "1 item"
        return f"a list of {items}, each {accepted(item_of(entry))}"
    if "maxLength" in entry:
        return f"{_TYPES[entry['type']]} of {entry['minLength']} to {entry['maxLength']} characters"
    signs = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}
    limits = " and ".join(f"{sign} {number(entry[limit])}" for limit, sign in signs.items() if limit in entry)
    return f"{_TYPES[entry['type']]} {limits}".strip()


def number(value: float) -> str:
    """A number in few characters: no needless zeros, exponents for large and small ones."""
    return f"{value:.10g}"


def check_of(root: type[BaseModel], key: str) -> TypeAdapter[Any]:
    """Check of one setting, by its dotted key."""
    *groups, name = key.split(".")
    field = _class_of(root, groups).model_fields[name]
    checked: Any = Annotated[field.annotation, *field.metadata] if field.metadata else field.annotation
    return TypeAdapter(checked, config=Settings.model_config)


def _without_none(annotation: Any) -> Any:
    """The type of a setting that may be left out."""
    return next((each for each in get_args(annotation) if type(None) in get_args(annotation)), annotation)


def item_of(entry: Entry) -> Entry:
    """Description of an item of a list; of anything else the entry itself."""
    return entry.get("items") or entry.get("prefixItems", [entry])[0]


def scalar(text: str | list[str], entry: Entry) -> Any:
    """A number or a truth value where an entry is one and the text can be read as one, else the text."""
    if isinstance(text, list):
        return [scalar(each, item_of(entry)) for each in text]
    kinds = [each.get("type") for each in entry.get("anyOf", [entry])]
    if "boolean" in kinds and text.lower() in ("true", "false"):
        return text.lower() == "true"
    for kind, read in (("integer", int), ("number", float)):
        if kind in kinds:
            with suppress(ValueError):
                return read(text)
    return text


def problems(root: type[BaseModel], error: ValidationError) -> Iterator[Problem]:
    """A problem for each part of an error of `pydantic`, each key once."""
    known, found = set(), error.errors(include_url=False)
    in_lists = {each["loc"][:-1] for each in found}
    for each in found:
        if each["type"] == "too_short" and each["loc"] in in_lists:  # refused items are not counted
            continue
        for problem in _problems_of(root, each):
            if problem not in known:
                known.add(problem)
                yield problem


def _problems_of(root: type[BaseModel], error: Any) -> Iterator[Problem]:
    """Problems in one error, in words of the entry to which it belongs."""
    unknown = error["type"] in ("extra_forbidden", "invalid_key")
    entry: Entry = described(root)
    group: Entry = {}
    path: list[str] = []
    for part in error["loc"][:-1] if unknown else error["loc"]:
        if part == "[key]" and "names" in group:
            yield Problem(".".join([*path[:-1], shown(error["input"])]), f": {group['names']} is needed")
            return
        if (inner := inside(entry, part)) is None:
            break
        group, entry, path = entry, inner, [*path, _part(part)]
    key, cause = ".".join(path), error.get("ctx", {}).get("error")
    if isinstance(cause, SettingsError):
        yield from (Problem(".".join(filter(None, [key, inner])), text) for inner, text in cause.found)
    elif unknown:
        word = error["loc"][-1]
        yield Problem(".".join([*path, _part(word)]), _unknown(str(word), key, entry, described(root)))
    elif error["type"] == "missing":
        yield Problem(key, f": missing; {accepted(entry)} is needed")
    else:
        yield Problem(key, f" = {shown(error['input'])}: {_needed(error, entry)} is needed")


def _needed(error: Any, entry: Entry) -> str:
    """Accepted values in words, as the error or the entry to which it belongs says."""
    if isinstance(cause := error.get("ctx", {}).get("error"), ValueError):
        return str(cause)
    if error["type"] == "too_long" and isinstance(error["input"], (list, tuple)):
        return f"a list of at most {error['ctx']['max_length']} values"
    return accepted(entry) + misread(error["input"])


def inside(entry: Entry, part: Any) -> Entry | None:
    """Description of a setting in a group, or of an item of a list; None if there is none of this name."""
    if part in entry.get("properties", {}):
        return entry["properties"][part]
    if entry.get("type") == "array" and str(part).isdecimal():
        return item_of(entry)
    named = entry.get("additionalProperties")
    return named if isinstance(named, Mapping) else None


def keys_like(word: str, root: Entry) -> list[str]:
    """Dotted keys of settings with a part that begins with a word."""
    start = word.lower().replace("-", "_")
    known = [key for key, entry in entries(root) if not item_of(entry).get("properties")]
    return [key for key in known if any(part.startswith(start) for part in key.split("."))]


def _unknown(word: str, group: str, entry: Entry, root: Entry) -> str:
    """Message on an unknown key, after the key."""
    if "names" in entry:
        return f": {entry['names']} is needed"
    if not entry["properties"]:
        return ": unknown key; the group has no keys, write {}"
    near = did_you_mean(word, entry["properties"])
    if not near and (keys := keys_like(word, root)):
        near = f"; did you mean {keys[0]}?"
    return f": unknown key{near or '; known here are ' + ', '.join(entry['properties'])}"


def _part(name: Any) -> str:
    """One part of a dotted key, as a message shows it."""
    return str(name) if len(str(name)) <= _LONGEST_KEY and str(name).isprintable() else shown(name)


def one_of(known: Iterable[str]) -> Any:
    """The type of a text that is one of the known words, for words that another module lists."""
    words = tuple(known)

    def check(value: Any) -> Any:
        if value not in words:
            raise NeededError(" or ".join(words))
        return value

    return Annotated[str, PlainValidator(check), WithJsonSchema({"type": "string", "enum": list(words)})]

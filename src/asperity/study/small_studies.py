"""Small studies in the folder ``studies``: results that are computed once, and pages from templates."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr
from jinja2 import Environment, StrictUndefined


def computed_once(path: Path, settings: Any, compute: Callable[[], xr.Dataset]) -> xr.Dataset:
    """The dataset in a file, computed and written first unless the file was made with these settings."""
    text = json.dumps(settings, default=str)
    if not path.exists() or xr.load_dataset(path).attrs["settings"] != text:
        print(path.stem, flush=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        compute().assign_attrs(settings=text).to_netcdf(path)
    return xr.load_dataset(path)


def rendered(template: Path, filters: dict[str, Callable[..., Any]] | None = None, **values: Any) -> str:
    """Text of a template with these values; a missing one is an error."""
    environment = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters.update(filters or {})
    return environment.from_string(template.read_text(encoding="utf-8")).render(**values) + "\n"

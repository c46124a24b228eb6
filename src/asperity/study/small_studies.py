"""Small studies in the folder ``studies``: results that are computed once, and pages from templates."""

import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pandas as pd
import xarray as xr
import yaml
from jinja2 import Environment, StrictUndefined
from matplotlib.figure import Figure

from asperity.views.style import save, style


def write_study(
    name: str,
    table: Callable[[Any], pd.DataFrame],
    draw: Callable[[pd.DataFrame], Figure],
    page: Callable[[pd.DataFrame], str],
) -> None:
    """Write table, figure and page of a study: ``NAME.csv``, ``.png``, ``README.md`` in ``studies/NAME``.

    The table is computed from the configuration that the command line names, and kept if it names none.
    """
    kept = Path("studies", name, f"{name}.csv")
    if sys.argv[1:]:
        config = yaml.safe_load(Path(sys.argv[1]).read_text(encoding="utf-8"))
        table(config).to_csv(kept, index=False, float_format="%.6g")
    rows = pd.read_csv(kept)
    with style():
        save(draw(rows), kept.with_suffix(".png"))
    kept.with_name("README.md").write_text(page(rows), encoding="utf-8")


def computed_once(
    path: Path, settings: Any, compute: Callable[..., xr.Dataset], *arguments: Any
) -> xr.Dataset:
    """The dataset in a file, computed and written first unless the file was made with these settings."""
    text = json.dumps(settings, default=str)
    if not path.exists() or xr.load_dataset(path).attrs["settings"] != text:
        print(path.stem, flush=True)
        path.parent.mkdir(parents=True, exist_ok=True)
        compute(*arguments).assign_attrs(settings=text).to_netcdf(path)
    return xr.load_dataset(path)


def rendered(template: Path, filters: dict[str, Callable[..., Any]] | None = None, **values: Any) -> str:
    """Text of a template with these values; a missing one is an error."""
    environment = Environment(undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters.update(filters or {})
    return environment.from_string(template.read_text(encoding="utf-8")).render(**values) + "\n"

"""Compute the contact of the surfaces of a configuration and write docs/nayak.md with its figure and table.

    python -m asperity.paper.nayak config/nayak.yaml

Samples that are there already are not computed again. Without a configuration the page is written again from
the table that is kept, docs/nayak.csv.
"""

import sys
from pathlib import Path

import pandas as pd

from asperity.config.study import read_study
from asperity.errors import ConfigError, DatasetError
from asperity.paper.claims.documents import with_sections
from asperity.paper.nayak.analysis import table, with_logarithms
from asperity.paper.nayak.collection import collect
from asperity.paper.nayak.figure import draw
from asperity.paper.nayak.page import sections
from asperity.views.style import save, style

TABLE, PAGE, PICTURE = Path("docs/nayak.csv"), Path("docs/nayak.md"), Path("docs/nayak.png")

try:
    if sys.argv[1:]:
        config = read_study(sys.argv[1:])
        rows = table(config, collect(config))
        rows[[name for name in rows if not name.startswith("ln_")]].to_csv(
            TABLE, index=False, float_format="%.6g"
        )
except (ConfigError, DatasetError) as error:
    sys.exit(f"nayak: {error}")
rows = with_logarithms(pd.read_csv(TABLE))
with style():
    save(draw(rows), PICTURE)
PAGE.write_text(with_sections(PAGE.read_text(encoding="utf-8"), sections(rows)), encoding="utf-8")

"""Compute peaks and lengths of the surfaces of a configuration and write docs/master_curve.md and its figure.

    python -m asperity.paper.master_curve config/master_curve.yaml

Samples that are there already are not computed again. Without a configuration the page is written again from
the table that is kept, docs/master_curve.csv.
"""

import sys
from pathlib import Path

import pandas as pd

from asperity.config.study import read_study
from asperity.errors import ConfigError, DatasetError
from asperity.paper.claims.documents import with_sections
from asperity.paper.master_curve.analysis import table
from asperity.paper.master_curve.figure import draw
from asperity.paper.master_curve.page import sections
from asperity.paper.master_curve.samples import collect
from asperity.views.style import save, style

TABLE, PAGE, PICTURE = (Path(f"docs/master_curve.{suffix}") for suffix in ("csv", "md", "png"))

try:
    if sys.argv[1:]:
        table(collect(read_study(sys.argv[1:]))).to_csv(TABLE, index=False, float_format="%.6g")
except (ConfigError, DatasetError) as error:
    sys.exit(f"master_curve: {error}")
rows = pd.read_csv(TABLE)
with style():
    save(draw(rows), PICTURE)
PAGE.write_text(with_sections(PAGE.read_text(encoding="utf-8"), sections(rows)), encoding="utf-8")

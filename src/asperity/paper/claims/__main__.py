"""Keep the verdicts of an ensemble, and write what README.md and docs/claims.md say of them.

    python -m asperity.paper.claims [FOLDER]

With the folder of results of an ensemble its tables replace docs/ensemble.csv and docs/ensemble.md first.
"""

import sys
from pathlib import Path

from asperity.paper.claims.documents import keep, update

for folder in sys.argv[1:2]:
    keep(Path(folder))
update()

"""Write the tables and the figure of docs/multilevel.md from the results of config/multilevel.yaml.

python -m asperity.paper.ensemble results/multilevel
"""

import sys
from pathlib import Path

from asperity.paper.ensemble.documents import keep

for folder in sys.argv[1:2] or ["results/multilevel"]:
    keep(Path(folder))

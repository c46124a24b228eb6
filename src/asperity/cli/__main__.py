"""``python -m asperity.cli``, the same as ``asperity``."""

import sys

from asperity.cli.main import main

sys.exit(main())

"""``python -m asperity``, the same as ``asperity``."""

import sys

from asperity.cli.main import main

if __name__ == "__main__":
    sys.exit(main())

"""``python -m cosim.cli``: the command ``cosim`` where it is not installed."""

import sys

from cosim.cli import main

sys.exit(main())

"""One side of one case, in this process: ``python -m cosim.conformance CASE claim|control FILE``."""

from __future__ import annotations

import sys
from pathlib import Path

from cosim.conformance.suite import serve

if __name__ == "__main__":
    serve(sys.argv[1], sys.argv[2], Path(sys.argv[3]))

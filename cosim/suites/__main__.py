"""Tells users of ``python -m cosim.suites``, a program of earlier versions, what has replaced it."""

from __future__ import annotations

import sys

if __name__ == "__main__":
    print(
        "cosim: suites are checked by cosim check suite:NAME; all of them, with their page, by "
        "python -m studies.protocols in a checkout of the repository",
        file=sys.stderr,
    )
    sys.exit(2)

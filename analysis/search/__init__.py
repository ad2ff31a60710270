"""The parts of a search for failures that need no run: axes, margins, kinds of failures, boundaries."""

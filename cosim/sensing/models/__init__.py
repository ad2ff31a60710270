"""One sensing model per file."""

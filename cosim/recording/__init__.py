"""Recording of a run: tables, the description of the run and their folder."""

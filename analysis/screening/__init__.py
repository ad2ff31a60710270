"""Which crossings of a network are dangerous, from runs that record everybody."""

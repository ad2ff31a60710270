"""One run: its request, composition, rehearsal, simulation and analysis."""

"""Evaluation of recorded runs by test protocols: impact, colours, points, verdicts."""

"""Evaluation of recorded runs by test protocols: impacts, colours, points and verdicts."""

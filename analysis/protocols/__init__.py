"""What test protocols ask of a recorded run: impact, colours, points, verdicts."""

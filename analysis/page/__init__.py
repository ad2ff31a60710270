"""The report as one HTML file, with replays of encounters."""

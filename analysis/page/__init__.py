"""The report as one HTML file, and the replay of encounters."""

"""Real trajectories onto a network, and into the files of a recorded run."""

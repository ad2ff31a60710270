"""Places real trajectories on a network and writes them as the files of a recorded run."""

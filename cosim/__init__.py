"""Co-simulation of ego controllers with SUMO: worlds, the step, recording and the command line."""

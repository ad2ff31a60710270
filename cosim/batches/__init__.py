"""Many runs: a study's matrix, the processes that make it, and the folder that keeps it."""

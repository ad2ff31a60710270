"""Many runs: the matrix of a study, the processes that make its runs, and the folder that keeps them."""

"""Many runs: read, summed up, compared and written."""

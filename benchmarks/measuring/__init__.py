"""What the benchmarks share: recorded perceptions, stopwatches, and where results are written."""

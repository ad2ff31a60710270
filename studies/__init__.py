"""Published studies: files that ``cosim batch`` reads, and the Python that makes their pages; not installed."""

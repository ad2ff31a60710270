"""Published studies and the papers' experiments, with the Python that makes their pages; not installed."""

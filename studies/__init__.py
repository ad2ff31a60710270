"""Published studies and the papers' experiments, with the code that makes their pages; not installed."""

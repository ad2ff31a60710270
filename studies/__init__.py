"""Published studies: files for ``cosim batch``, and the Python that makes their pages; not installed."""

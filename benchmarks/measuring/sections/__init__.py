"""The sections of the results page, one module each."""

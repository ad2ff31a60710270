"""The cases, by subject. Every module has ``CASES``; the suite finds them by itself."""

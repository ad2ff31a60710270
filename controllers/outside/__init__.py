"""Controllers that no package announces: given as an object, or kept in a file beside the user's work."""

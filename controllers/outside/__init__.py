"""Controllers from outside any installed package: given as an object, or kept in a file of the user."""

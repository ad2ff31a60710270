"""The last check of a plan before it is carried out."""

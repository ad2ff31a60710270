"""The last check of a plan before it is executed, the way out of a jam, and emergency braking."""

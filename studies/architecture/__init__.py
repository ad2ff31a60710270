"""Pictures of the architecture, drawn from the code as it is."""

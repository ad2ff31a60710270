"""What a run has recorded: its columns, and how they are read."""

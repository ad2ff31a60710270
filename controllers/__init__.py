"""Vehicle controllers: how the ego drives, given what it perceives."""

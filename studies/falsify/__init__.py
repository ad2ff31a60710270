"""What breaks the controllers: the same search for each."""

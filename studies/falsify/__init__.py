"""Study of what breaks the controllers: the same search for each."""

"""Vehicle controllers: what an ego does with what it perceives."""

"""What a search for failures is made of that needs no run: axes, margins, kinds of failures, boundaries."""

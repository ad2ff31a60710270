"""Speed plans in pieces, for what is ahead."""

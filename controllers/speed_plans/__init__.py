"""Speed plans, made of pieces of constant acceleration or jerk, for what is ahead."""

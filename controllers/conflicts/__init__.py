"""Who crosses the ego's way: passing order, collision cones, hidden places."""

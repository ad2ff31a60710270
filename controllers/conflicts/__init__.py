"""Who is in conflict with the ego's way: in it, beside it, or hidden where nobody can be seen."""

"""What the analysis finds in one run: every metric, and the rows and files made of them."""

"""Results of the analysis of one run: every metric, and the rows and files made of them."""

"""Results of the analysis of one run: all metrics, and the rows and files made from them."""

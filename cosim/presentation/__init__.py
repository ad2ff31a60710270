"""What finished runs say: their numbers, comparisons, reports and pictures."""

"""What a check demands, read and judged."""

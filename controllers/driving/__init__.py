"""Parts that every method needs to drive in traffic: vehicles ahead, right of way, speeds, lanes."""

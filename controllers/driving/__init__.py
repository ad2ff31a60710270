"""What every method needs to drive in traffic: rules, lanes, vehicles ahead, braking in an emergency."""

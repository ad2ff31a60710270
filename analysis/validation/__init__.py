"""Is a simulation like the street? Values of road users, their comparison, and estimates of parameters."""

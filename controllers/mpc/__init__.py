"""The model predictive controller: speed and steering as two quadratic programs."""

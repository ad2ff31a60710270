"""Model predictive control (``vo_mpc``): speed and steering as two quadratic programs."""

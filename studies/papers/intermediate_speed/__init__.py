"""The intermediate-speed paper: drives, claims and figures."""

"""The intermediate-speed paper: its drives, claims and figures."""

"""The papers' experiments, run on the road without SUMO, and the results of checking their claims."""

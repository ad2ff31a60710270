"""The experiments of the papers, run on the road without SUMO, and what became of their claims."""

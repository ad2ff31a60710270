"""Recorded encounters in the formats of other tools: OpenSCENARIO with OpenDRIVE, and SUMO's FCD."""

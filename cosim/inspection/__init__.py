"""What a SUMO network and its demand offer to a study of pedestrian crossings; runs no simulation."""

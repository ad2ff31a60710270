"""The SUMO world: the only package that touches libsumo or traci."""

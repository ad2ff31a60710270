"""The seam between worlds and controllers, the step over it, the car that is moved, a road without SUMO."""

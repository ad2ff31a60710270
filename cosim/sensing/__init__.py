"""What egos can know of pedestrians: models between the world's truth and the controllers' perception."""

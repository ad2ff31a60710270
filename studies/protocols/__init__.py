"""Every test protocol with every controller, and the page of their verdicts."""

"""Study of all test protocols with all controllers, and the page of their verdicts."""

"""Controllers that are functional mock-up units: ``--controller fmu:acc.fmu``."""

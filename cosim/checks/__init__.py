"""Scenarios, studies and suites that pass or fail: criteria, baselines, JUnit and exit codes."""

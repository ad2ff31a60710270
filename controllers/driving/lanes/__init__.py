"""Lanes: keeping one, choosing another and moving over, as any driver does."""

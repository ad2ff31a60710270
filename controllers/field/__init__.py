"""Steering down a potential field."""

"""Tests of how SUMO treats an ego that is driven from outside."""

"""Arithmetic that fills the programs: functions of numbers and arrays only."""

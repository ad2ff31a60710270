"""Arithmetic on arrays: functions of numbers and arrays, nothing else."""

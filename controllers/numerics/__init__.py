"""Arithmetic on arrays that runs as it stands or compiled: functions of numbers and arrays, nothing else."""

"""Arithmetic on arrays that fills the programs: functions of numbers and arrays, nothing else."""

"""Compares a simulation with the street: values of road users, their comparison, parameter estimates."""

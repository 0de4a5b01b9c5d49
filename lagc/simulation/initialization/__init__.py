"""Consistent initial conditions of a run, and what is wrong with inconsistent ones."""

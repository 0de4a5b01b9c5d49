"""Consistent initial conditions."""

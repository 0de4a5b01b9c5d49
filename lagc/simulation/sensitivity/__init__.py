"""Derivatives of a run by parameters and initial conditions."""

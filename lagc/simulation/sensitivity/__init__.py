"""Sensitivities of a motion to parameters, inputs and initial values."""

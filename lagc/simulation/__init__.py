"""Simulation of a compiled model.

From a `System` (generated code with parameter values) and a `Request` to a `Solution` and its files.  The
room finds a consistent initial state, chooses method and tolerance, estimates the global error, and
explains failures.
"""

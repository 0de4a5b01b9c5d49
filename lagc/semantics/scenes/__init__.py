"""Scenes: which effects, parameters and settings a run uses."""

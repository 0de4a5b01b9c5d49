"""Warnings on models: discontinuities, degenerate constraints, the direction of loads."""

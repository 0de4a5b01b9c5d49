"""Redundant constraints."""

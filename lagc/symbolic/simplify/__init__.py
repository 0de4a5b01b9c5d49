"""Simplification of expressions."""

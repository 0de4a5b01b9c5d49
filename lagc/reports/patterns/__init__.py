"""Patterns in formulas: index rules and recursion."""

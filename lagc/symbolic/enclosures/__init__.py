"""Enclosures of expressions: bounds that hold for every value of an interval."""

"""Explanations of common syntax mistakes, one function each."""

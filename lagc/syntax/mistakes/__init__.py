"""Syntax mistakes in the user's terms, one function each."""

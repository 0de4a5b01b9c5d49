"""Algebra for readable equations: expansion, collection, trigonometric identities."""

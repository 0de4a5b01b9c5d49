"""Projection onto the constraint manifold."""

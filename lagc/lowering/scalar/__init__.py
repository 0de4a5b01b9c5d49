"""Scalar code: value numbering, common factors, scheduling."""

"""Trigonometric functions and quaternions."""

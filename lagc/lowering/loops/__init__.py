"""Loop rerolling and independent blocks."""

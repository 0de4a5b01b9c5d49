"""Runs of a known error: a run and its check."""

"""Helpers for every room: records, and text."""

"""The version of lagc."""

__version__ = "0.1.0"

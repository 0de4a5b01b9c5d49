"""lagc: from a mechanical system to its motion."""

__version__ = "0.1.0"

"""The Python target: one self-contained module of functions on Python floats."""

"""Hard cases: motions that are known, what makes them hard, and the figures that a run has to keep.

A case is a row of `cases.toml`: its texts, its figures, and the function that measures them.
"""

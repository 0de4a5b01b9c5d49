"""Motion.

In: `System` (generated code with parameters) and `Request`.  Out: `Solution`, with its files.  Consistent
starts and the choice of tolerance are made here.
"""

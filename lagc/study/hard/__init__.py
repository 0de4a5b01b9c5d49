"""Hard cases: motions that are known, what makes them hard, and the figures that a run has to keep.

A case is a row of `CASES` in one of the files here: texts, figures and a function that measures them.
"""

"""Operations to text.

In: `Program`.  Out: files of C99, or a Python module; with them the hand-written support: integrators,
projection, linear algebra.
"""

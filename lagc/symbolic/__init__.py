"""Expressions as a graph of interned nodes.

In: symbols and numbers.  Out: `Node`, with its derivatives, value and text.  Built-alike expressions are
one object; every walk is a loop.
"""

"""Expressions as a graph of interned nodes.

In: symbols and numbers.  Out: `Node`, with its derivatives, value and text.  Equal expressions are one
object, and every walk is a loop.
"""

"""Text to syntax tree.

In: `Source`.  Out: `Tree`, or all faults of the syntax.  Nothing is looked up here; the formatter lives
here too.
"""

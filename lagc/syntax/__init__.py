"""From text to syntax tree.

In: `Source`.  Out: `Tree`, or all faults of the syntax.  No names are looked up here.  The formatter is here
too.
"""

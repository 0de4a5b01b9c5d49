"""Answers about one text, for editors: faults and their fixes, hover, completion, names, colours.

Only `server` knows a protocol. Nothing here needs NumPy.
"""

"""What is wrong, where, and what to do about it.

In: places in a text.  Out: `Fault`, `Refused`, and reports for people and programs.  Every code has an
entry in the catalogue.  No room is before this one.
"""

"""Faults: messages with their place and a remedy.

In: places in a text.  Out: `Fault`, `Refused`, and reports for people and programs.  Every code has an entry
in the catalogue.
"""

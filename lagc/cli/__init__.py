"""The commands, one file each.

In: words of the command line.  Out: text on standard output, an exit code.
"""

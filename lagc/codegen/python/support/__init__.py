"""Options and trajectories of generated Python modules.

Generated modules contain each file from its marker on.  Runs of lagc import the files.
"""

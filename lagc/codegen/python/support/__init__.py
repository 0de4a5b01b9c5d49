"""What generated Python modules have besides their functions and the kernels: statuses, options and
trajectories.

Each file is part of generated modules from its marker on, and importable here, as runs of lagc use it too.
"""

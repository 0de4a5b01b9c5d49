"""Kernels -> C and Python: the printers of the runtime that `lagc.kernels` holds."""

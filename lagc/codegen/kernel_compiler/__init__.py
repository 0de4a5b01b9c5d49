"""The kernel compiler: read kernels (`lagc.kernels`), check their types, and print them as C and Python."""

from numpy import ndarray as NDArray  # noqa: F401

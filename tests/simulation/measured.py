"""True errors of a verified run, by the scales that it tells."""

from collections.abc import Sequence

from lagc.api import Run


def worst_error(run: Run, states: Sequence[Sequence[float]]) -> float:
    """The largest difference of coordinates and speeds to exact `states`, over the scale of each."""
    scales = [run.scales[name] for name in run.state_names]
    shares = [
        abs(a - b) / scale
        for row, exact in zip(run.states, states)
        for a, b, scale in zip(row, exact, scales)
        if scale
    ]
    return max(shares, default=0.0)

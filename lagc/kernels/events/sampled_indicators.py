"""Ranges of indicators that are sampled: forces of contacts, and what accelerations or reactions decide.

Each of their values needs a solve of the equations of motion, so they have no enclosure. In place of one they
have the hull of their samples over a part of a step, widened by a quarter of its length on each side.
"""

from lagc.kernels.language.vocabulary import *

SAMPLE_MARGIN = 0.25  # of the range of samples: what is added to it


def forget_samples(first: Size, last: Size, w: Work) -> None:
    """Begin the ranges of relations first..last - 1 anew."""
    for k in range(first, last):
        w.events.sampled_low[k] = UNKNOWN
        w.events.sampled_high[k] = -UNKNOWN


def add_sample(k: int, value: Real, w: Work) -> None:
    """Add a value to the range of a relation."""
    if value < w.events.sampled_low[k]:
        w.events.sampled_low[k] = value
    if value > w.events.sampled_high[k]:
        w.events.sampled_high[k] = value


def enclose_samples(k: int, w: Work) -> None:
    """Set w.events.enclosures of a relation to its range, widened."""
    more = SAMPLE_MARGIN * (w.events.sampled_high[k] - w.events.sampled_low[k])
    w.events.enclosures[2 * (k - NTIMED)] = w.events.sampled_low[k] - more
    w.events.enclosures[2 * (k - NTIMED) + 1] = w.events.sampled_high[k] + more

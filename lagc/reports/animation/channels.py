"""Columns of numbers as 16-bit integers: half the size of single precision, and exact enough to be drawn."""

from __future__ import annotations

import base64
import hashlib
from typing import Any

import numpy as np

from lagc.reports.animation.arrays import Array

LEVELS = 65_534
NO_VALUE = 65_535


class Channels:
    """One block of little-endian 16-bit integers. A channel is `[value]` if it is constant, else `[low, high,
    offset]`: its values between low and high, exact to 1/131070 of the range. Equal channels are stored
    once."""

    def __init__(self) -> None:
        self.parts: list[Any] = []
        self.size = 0
        self.offsets: dict[bytes, int] = {}

    def add(self, x: Any) -> list[float]:
        """Store a column and return its channel."""
        x = np.asarray(x, float)
        finite = x[np.isfinite(x)]
        low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
        if high - low <= 1e-13 * max(abs(low), abs(high)) and len(finite) == len(x):
            return [low]
        share = (x - low) / (high - low or 1.0)
        levels = np.where(np.isfinite(x), np.round(np.nan_to_num(share) * LEVELS), NO_VALUE).astype("<u2")
        key = hashlib.sha256(levels.tobytes()).digest()
        if key not in self.offsets:
            self.offsets[key] = self.size
            self.parts.append(levels)
            self.size += len(levels)
        return [low, high, self.offsets[key]]

    def add_all(self, rows: Any) -> list[list[float]]:
        return [self.add(row) for row in rows]

    def add_times(self, t: Array) -> list[list[float]]:
        """Store times as two channels whose sum they are, exact to 1/131070^2 of the range."""
        first = self.add(t)
        if len(first) == 1:
            return [first]
        return [first, self.add(t - decode(first, self, len(t)))]

    def block(self) -> bytes:
        return b"".join(part.tobytes() for part in self.parts)

    def text(self) -> str:
        return base64.b64encode(self.block()).decode()


def decode(channel: list[float], channels: Channels, n: int) -> Array:
    """Return the n values of a channel, as the page reads them."""
    if len(channel) == 1:
        return np.full(n, channel[0])
    low, high, offset = channel
    words = np.frombuffer(channels.block(), "<u2", n, 2 * int(offset)).astype(float)
    return np.where(words == NO_VALUE, np.nan, low + (high - low) * words / LEVELS)

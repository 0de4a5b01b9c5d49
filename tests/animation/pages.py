"""A reader of animation pages that shares no code with lagc."""

import base64
import json
import re
import struct
from typing import Any

import numpy as np

BLOCK = re.compile(r'<script type="application/json" id="data">(.*?)</script>', re.DOTALL)


class Page:
    """The decoded data of a page.  `t` are the times of its first run."""

    def __init__(self, text: str):
        (block,) = BLOCK.findall(text)
        self.text, self.data = text, json.loads(block)
        packed = base64.b64decode(self.data["blob"], validate=True)
        self.words = struct.unpack(f"<{len(packed) // 2}H", packed)
        self.n = self.data["counts"][0]
        self.t = self.sum(self.data["runs"][0]["t"], self.n)

    def channel(self, channel: list[float], n: int) -> Any:
        if len(channel) == 1:
            return np.full(n, channel[0])
        low, high, first = channel
        words = np.array(self.words[int(first) : int(first) + n], float)
        return np.where(words == 65535.0, np.nan, low + (high - low) * words / 65534.0)

    def sum(self, channels: list[list[float]], n: int) -> Any:
        return sum(self.channel(c, n) for c in channels)

    def place(self, name: str, kind: str = "body") -> int:
        return next(
            i for i, p in enumerate(self.data["places"]) if p and (p["name"], p["kind"]) == (name, kind)
        )

    def path(self, name: str, times: Any, kind: str = "body", run: int = 0) -> Any:
        """Where a place is drawn at `times`, (len(times), 3): between frames along straight lines."""
        of_run, n = self.data["runs"][run], self.data["counts"][run]
        t = self.sum(of_run["t"], n)
        return np.stack(
            [np.interp(times, t, self.channel(c, n)) for c in of_run["P"][str(self.place(name, kind))]], 1
        )

    def force(self, name: str, kind: str = "reaction") -> tuple[Any, Any]:
        """The place and the vector of an arrow at the frames, (n, 3)."""
        (found,) = [f for f in self.data["forces"] if (f["name"], f["kind"]) == (name, kind)]
        return tuple(np.stack([self.channel(c, self.n) for c in found[part]], 1) for part in "pv")

    def decode_all(self) -> int:
        """Decode every channel of the page and return how many numbers they have."""
        data, count = self.data, 0
        for run, n in zip(data["runs"], data["counts"]):
            rows = [*run["t"], *(c for table in (run["P"], run["Q"]) for row in table.values() for c in row)]
            count += sum(len(self.channel(c, n)) for c in rows)
        for f in data["forces"]:
            count += sum(len(self.channel(c, self.n)) for c in (*f["p"], *f["v"]))
        for panel in data["panels"]:
            for column in panel["columns"]:
                rows = [(y, n) for y, n in zip(column["y"], data["points"]) if y is not None]
                count += sum(len(self.channel(y, n)) for y, n in rows)
        return count

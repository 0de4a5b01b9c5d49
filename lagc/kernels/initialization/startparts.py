"""The derivatives of conditions that build on sums: those by unknowns, from those by unknowns and sums."""

from __future__ import annotations

from lagc.kernels.language.sizes import NCOND, NJ, NPARTS, NU, NWHOLE
from lagc.kernels.language.tables import ends, part_column, part_ends, stretch_begins, stretch_ends
from lagc.kernels.language.words import Vec, vector


def part_begin(i: int) -> int:
    """Where the parts of condition i begin, behind the conditions those of sums."""
    return part_ends[i - 1] if i > 0 else 0


def put_together(J: Vec[NJ]) -> None:
    """J from its parts, which stand first in it: a derivative by a sum goes to what that is made of, the last
    sum of a condition first."""
    parts = vector(NPARTS)
    for k in range(NPARTS):
        parts[k] = J[k]
    total = vector(NWHOLE)
    for j in range(NWHOLE):
        total[j] = 0.0
    made = 0
    stretch = 0
    for i in range(NCOND):
        first = part_begin(i)
        end = part_ends[i]
        last = -1
        for k in range(first, end):
            total[part_column[k]] = parts[k]
            if part_column[k] - NU > last:
                last = part_column[k] - NU
        for n in range(last + 1):
            at = last - n
            slope = total[NU + at]
            total[NU + at] = 0.0
            if slope != 0.0:
                first = part_begin(NCOND + at)
                end = part_ends[NCOND + at]
                for k in range(first, end):
                    total[part_column[k]] += slope * parts[k]
        while made < ends[i]:
            for j in range(stretch_begins[stretch], stretch_ends[stretch]):
                J[made] = total[j]
                total[j] = 0.0
                made += 1
            stretch += 1

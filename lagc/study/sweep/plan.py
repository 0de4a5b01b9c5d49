"""The points of a sweep: values, grids, tables and random samples.

A plan is a product of blocks, the last one fastest.  A block has one name, or several whose values go
together: a table, axes that are zipped, a random sample.  No list of all points is made.
"""

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from math import isfinite, prod
from random import Random

from lagc.base.records import dataclass
from lagc.base.text import number, whole
from lagc.diagnostics.faults import Fault, Refused
from lagc.diagnostics.suggest import did_you_mean

MOST_VALUES = 100_000_000  # of an axis


@dataclass(frozen=True)
class Block:
    """Columns of values in SI units that go together; `columns[i]` are those of `names[i]`.  `kind` is the
    name of their dimension, unless they have one name alone that is no random sample."""

    names: tuple[str, ...]
    columns: tuple[Sequence[float], ...]
    kind: str = "point"

    def __len__(self) -> int:
        return len(self.columns[0])


@dataclass(frozen=True)
class Plan:
    """The points of a sweep, numbered from 0 on; `seed` is that of its random samples."""

    blocks: tuple[Block, ...]
    seed: int | None = None

    def __len__(self) -> int:
        return prod(map(len, self.blocks))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all axes."""
        return tuple([name for block in self.blocks for name in block.names])

    def points(self, first: int, count: int) -> Iterator[tuple[float, ...]]:
        """The values of the points from `first` on, in the order of `names`."""
        for k in range(first, first + count):
            values: list[float] = []
            for block in reversed(self.blocks):
                k, row = divmod(k, len(block))
                values[:0] = [column[row] for column in block.columns]
            yield tuple(values)


# Random numbers of a generator, and the conditions of their arguments.
DISTRIBUTIONS: dict[str, tuple[Callable[..., float], str, Callable[..., bool]]] = {
    "uniform": (Random.uniform, "(least, largest)", lambda low, high: low < high),
    "normal": (Random.normalvariate, "(mean, standard deviation)", lambda _, deviation: deviation > 0.0),
    "lognormal": (
        lambda dice, median, deviation: median * dice.lognormvariate(0.0, deviation),
        "(median, standard deviation of the logarithm)", lambda median, deviation: median and deviation > 0.0
    ),
    "loguniform": (
        lambda dice, low, high: low * (high / low) ** dice.random(),
        "(least, largest), both positive", lambda low, high: 0.0 < low < high
    ),
    "triangular": (
        lambda dice, low, mode, high: dice.triangular(low, high, mode),
        "(least, most frequent, largest)", lambda a, b, c: a <= b <= c and a < c
    ),
}  # fmt: skip


@dataclass(frozen=True)
class Distribution:
    """A distribution of values in `unit` (None: SI)."""

    kind: str
    arguments: tuple[float, ...]
    unit: str | None = None

    def sample(self, name: str, count: int, seed: int) -> list[float]:
        """Return values that depend on the name, the seed and their number alone."""
        dice, value = Random(f"{seed} {name}"), DISTRIBUTIONS[self.kind][0]
        return [value(dice, *self.arguments) for _ in range(count)]


@dataclass(frozen=True)
class Values:
    """Values of an axis in `unit` (None: SI)."""

    numbers: Sequence[float]
    unit: str | None = None


def parse(name: str, text: str) -> Values | Distribution:
    """Return the axis of a text: `1,2,5`, `0.5:1.5:100` (both ends), `1e-3:1:7:log`, or a distribution such
    as `normal(1, 0.05)`; each may end with a `[unit]`.  Raises Refused (LAG0602)."""
    body, bracket, rest = text.strip().partition("[")
    unit = rest[:-1].strip() if bracket else None
    if bracket and (rest[-1:] != "]" or "[" in rest):
        raise wrong(name, text, "the unit stands once, at the end", f"{name}=0.5:1.5:100[m]")
    body = body.strip()
    called = re.fullmatch(r"(\w+)\s*\(([^()]*)\)", body)
    if called is not None:
        return _distribution(name, text, called[1], called[2].split(","), unit)
    if ":" in body:
        return Values(_range(name, text, body.split(":")), unit)
    return Values([_number(name, text, word) for word in body.split(",")], unit)


def wrong(name: str, text: str, reason: str, like: str) -> Refused:
    return Refused([Fault("LAG0602", f"`{name}={text.strip()}`: {reason}", remedy=f"write `{like}`")])


def _number(name: str, text: str, word: str) -> float:
    value = number(word.strip())
    if value is None or not isfinite(value):
        like = f"{name}=1,2,5` or `{name}=0.5:1.5:100"
        raise wrong(name, text, f"`{word.strip()}` is not a finite number", like)
    return value


def _range(name: str, text: str, words: Sequence[str]) -> list[float]:
    """Return numbers of equal distances, or of equal ratios, with both ends."""
    form = "FIRST:LAST:COUNT, or FIRST:LAST:COUNT:log, is the form of a range"
    if len(words) not in (3, 4) or (len(words) == 4 and words[3].strip() != "log"):
        raise wrong(name, text, form, f"{name}=0.5:1.5:100")
    first, last = (_number(name, text, word) for word in words[:2])
    count = whole(words[2].strip())
    if count is None or not 1 <= count <= MOST_VALUES:
        raise wrong(name, text, f"`{words[2].strip()}` is not a number of values", f"{name}=0.5:1.5:100")
    parts = [k / max(count - 1, 1) for k in range(count)]
    if len(words) == 3:
        found = [first + (last - first) * part for part in parts]
    elif first * last > 0.0:
        found = [first * (last / first) ** part for part in parts]
    else:
        raise wrong(name, text, "the ends of a logarithmic range have one sign", f"{name}=1e-3:1:7:log")
    return [*found[:-1], last] if count > 1 else found


def _distribution(name: str, text: str, kind: str, words: Sequence[str], unit: str | None) -> Distribution:
    if kind not in DISTRIBUTIONS:
        raise Refused([Fault("LAG0602", f"`{name}={text.strip()}`: there is no distribution `{kind}`",
                             remedy=did_you_mean(kind, DISTRIBUTIONS)
                             or f"there are {', '.join(DISTRIBUTIONS)}")])  # fmt: skip
    _, about, holds = DISTRIBUTIONS[kind]
    arguments = tuple([_number(name, text, word) for word in words])
    if len(arguments) != about.count(",") + 1 - about.count(", both") or not holds(*arguments):
        raise wrong(name, text, f"`{kind}` needs {about}", f"{name}=normal(1, 0.05)")
    return Distribution(kind, arguments, unit)


def plan_of(
    axes: Mapping[str, Values | Distribution],
    to_si: Callable[[str, Sequence[float], str | None], list[float]],
    zipped: bool = False, samples: int | None = None, seed: int = 0,
) -> Plan:  # fmt: skip
    """Return the plan of axes by name: the product of those that have values, or their rows if they are
    `zipped`, then `samples` random points at each of them.  `to_si(name, numbers, unit)` converts values.
    Raises Refused (LAG0602)."""
    random = {name: axis for name, axis in axes.items() if isinstance(axis, Distribution)}
    if bool(random) != (samples is not None):
        example = "a distribution such as `m=normal(1, 0.05)` and a number of samples, `--monte-carlo 1000`"
        raise Refused([Fault("LAG0602", f"a random sweep needs both {example}")])
    if samples is not None and samples < 1:
        raise Refused([Fault("LAG0602", f"{samples} samples make no sweep")])
    columns = {n: to_si(n, axis.numbers, axis.unit) for n, axis in axes.items() if isinstance(axis, Values)}
    lengths = {name: len(column) for name, column in columns.items()}
    if 0 in lengths.values():
        raise Refused([Fault("LAG0602", f"`{min(lengths, key=lengths.__getitem__)}` has no values")])
    blocks = [Block((name,), (column,)) for name, column in columns.items()]
    if zipped and blocks:
        if len({*lengths.values()}) > 1:
            found = ", ".join(f"{count} of `{name}`" for name, count in lengths.items())
            raise Refused(
                [Fault("LAG0602", f"axes that are zipped have as many values as each other: {found}")]
            )
        blocks = [Block(tuple(columns), tuple(columns.values()))]
    if samples is not None:
        drawn = [to_si(n, axis.sample(n, samples, seed), axis.unit) for n, axis in random.items()]
        blocks.append(Block(tuple(random), tuple(drawn), "sample"))
    if not blocks:
        raise Refused([Fault("LAG0602", "a sweep needs values, such as `l=0.5:1.5:100`")])
    return Plan(tuple(blocks), None if samples is None else seed)

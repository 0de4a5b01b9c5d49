"""How the symbols of the equations are shown to people."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain, count
from math import prod
from typing import TypeAlias

from lagc.base.records import dataclass
from lagc.base.text import one_line
from lagc.mechanics.formulation.equations import ContactRow, EquationsOfMotion
from lagc.reports.algebra.expansion import TABLE
from lagc.symbolic.graph import Node
from lagc.symbolic.operators import OPERATORS


@dataclass(frozen=True, slots=True)
class Name:
    """The printed name of a symbol or table: `base` with a number of time derivatives; `full` is the name in
    the model, or the source of a table."""

    base: str
    full: str
    order: int = 0


# By symbol, or by the operator that a table is.
Names: TypeAlias = dict[Node | str, Name]


def names(equations: EquationsOfMotion) -> Names:
    """How each symbol is shown, `field.g` as `g` where no other name ends so, and each table."""
    model = equations.model
    given = [*(p.symbol for p in model.parameters), *model.undetermined]
    # Short names first: words for multipliers, forces, time and tables must not take one of them.
    plain = [*given, *(x for x in equations.q if not x.record.component)]
    short = _shortener([x.record.name for x in (*plain, *equations.v) if x.record.order == 0])
    found: Names = {}
    for symbol in (*plain, *equations.q, *equations.v, *equations.a):
        record = symbol.record
        base = record.base if record.component else short(record.base)
        found[symbol] = Name(base, record.base, record.order)
    pi = pi_of(equations)
    if pi is not None:
        found[pi] = Name("pi", "pi")
    taken = {n.base for n in found.values()}
    for row in equations.rows:
        word = _free(taken, f"lambda_{row.label}", f"multiplier_{row.label}")
        found[row.multiplier] = Name(word, word)
    for symbol, word, _ in forces_of_contacts(equations):
        word = _free(taken, word)
        found[symbol] = Name(word, word)
    found[equations.time] = Name(_free(taken, "t", "time"), "time")
    taken |= OPERATORS.keys()
    for table in model.tables:
        word = _free(taken, table.name, f"{table.name}_table")
        source = one_line(f"column {table.column} of {table.file}") if table.file else word
        found[TABLE + table.name] = Name(word, source)
    return found


def forces_of_contacts(equations: EquationsOfMotion) -> list[tuple[Node, str, str]]:
    """Return the symbols of forces and slips of contacts, and of the impulses of Poisson's law, each with a
    name and what it is."""
    found = list[tuple[Node, str, str]]()
    for contact in equations.contacts:
        label = contact.label
        found.append((contact.multiplier, f"{'N' if contact.normals else 'lambda'}_{label}",
                      f"normal force of {label}"))  # fmt: skip
        for k, slip in enumerate(contact.slips, 1):
            number = str(k) if len(contact.slips) > 1 else ""
            found.append((slip.force, f"F{number}_{label}", f"friction of {label}"))
            speed = slip_speeds(contact)[k - 1]
            found += [(speed, f"u{number}_{label}", f"slip of {label}")] if speed != slip.rate else []
        found += [(symbol, f"P{k}_{label}", f"impulse {k} of {label}") for k, symbol in impulses(contact)]
    return found


def slip_speeds(contact: ContactRow) -> list[Node]:
    """Return the slips of a contact, by symbols where they are no symbols."""
    symbol = contact.gap.graph.symbol
    return [
        slip.rate if slip.rate.op == "symbol" else symbol("slip", contact.label, str(k))
        for k, slip in enumerate(contact.slips, 1)
    ]


def impulses(contact: ContactRow) -> list[tuple[int, Node]]:
    """Return the impulses of compression, 1, and of restitution, 2, of a contact with Poisson's law."""
    if not contact.contact.poisson:
        return []
    return [(k, contact.gap.graph.symbol("impulse", contact.label, str(k))) for k in (1, 2)]


def _free(taken: set[str], *words: str) -> str:
    """The first that is not taken, else the last with a number; it is taken then."""
    numbered = (f"{words[-1]}_{k}" for k in count(2))
    found = next(word for word in chain(words, numbered) if word not in taken)
    taken.add(found)
    return found


def pi_of(equations: EquationsOfMotion) -> Node | None:
    """The symbol of pi; None where the model calls something else so."""
    model = equations.model
    names = [
        *(p.name for p in model.parameters),
        *(x.record.name for x in model.undetermined),
        *equations.q_names,
    ]
    taken = any(name.rpartition(".")[2] == "pi" for name in (*names, *equations.v_names))
    return None if taken else equations.graph.symbol("number", "pi")


def _shortener(full: Sequence[str]) -> Callable[[str], str]:
    ends: dict[str, set[str]] = {}
    for name in full:
        ends.setdefault(name.rpartition(".")[2], set()).add(name)
    return lambda name: name.rpartition(".")[2] if len(ends.get(name.rpartition(".")[2], ())) == 1 else name


def words_taken(shown: Mapping[Node | str, Name]) -> set[str]:
    """The words in names, which may be subscripts: counters are not called so."""
    return {word for name in shown.values() for word in re.split(r"[\W_]+", name.base)}


def where(seen: Iterable[Name]) -> list[tuple[str, str]]:
    """(short, full) of the names that were shortened."""
    return sorted({(n.base, n.full) for n in seen if n.base != n.full and n.full != "time"})


_SUBSCRIPTS = re.compile(r"(?<=[\w\]])\[(\d+(?:, ?\d+)*)\]")  # behind a name: no unit, which a space parts
_FEWEST = 3  # lines that are worth a range


def ranged(lines: Iterable[str]) -> list[str]:
    """`lines`, those of a family as one, in place of its first, where their subscripts fill whole ranges."""
    given = [*lines]
    families: dict[tuple[str, ...], list[tuple[int, tuple[int, ...]]]] = {}
    for place, line in enumerate(given):
        parts = _SUBSCRIPTS.split(line)  # what is between, and subscripts, in turn
        shape = [part if k % 2 == 0 else str(part.count(",")) for k, part in enumerate(parts)]
        numbers = [int(n) for part in parts[1::2] for n in part.split(",")]
        families.setdefault(tuple(shape), []).append((place, tuple(numbers)))
    # A range stands at the place of its first line.
    found = dict(enumerate(given))
    for members in families.values():
        texts = _texts([numbers for _, numbers in members]) if len(members) >= _FEWEST else None
        if texts is not None:
            (first, _), *others = members
            found[first] = _with(given[first], texts)
            for place, _ in others:
                del found[place]
    return [*found.values()]


def _texts(rows: Sequence[tuple[int, ...]]) -> list[str] | None:
    """Return the text of each subscript of `rows`; None where they do not fill ranges."""
    # A family is a product of ranges if it has as many members as the product, each once.
    columns = [*zip(*rows)]
    extents = {column: range(min(column), max(column) + 1) for column in columns}  # once, if always equal
    if prod(map(len, extents.values())) != len(rows) or len({*rows}) != len(rows):
        return None
    return [str(e[0]) if len(e) == 1 else f"{e[0]}..{e[-1]}" for e in map(extents.__getitem__, columns)]


def _with(line: str, texts: Iterable[str]) -> str:
    following = iter(texts)

    def next_text(found: re.Match[str]) -> str:
        return f"[{', '.join([next(following) for _ in found[1].split(',')])}]"

    return _SUBSCRIPTS.sub(next_text, line)

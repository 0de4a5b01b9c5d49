"""Which rules of the grammar texts are made of."""

from collections import Counter
from collections.abc import Iterable

from lagc.diagnostics.faults import Source
from lagc.syntax.lalr import Machine
from lagc.syntax.lalr_tables import tables
from lagc.syntax.lexer import tokenise
from lagc.syntax.recovery import recover


class _Counting(Machine):
    used: Counter[int]

    def reduce(self, number: int) -> None:
        self.used[number] += 1
        super().reduce(number)


def rules(texts: Iterable[str]) -> dict[str, int]:
    """How often each rule that makes a node is used by the texts, by what it makes."""
    own, used = tables(), Counter[int]()
    for text in texts:
        source = Source("text", text)
        machine = _Counting(source, own, tokenise(source))
        machine.used = used
        machine.run(recover)
    found: Counter[str] = Counter()
    for number, (_, _, name, _) in enumerate(own.rules):
        if name is not None:
            found[name] += used[number]
    return dict(found)

"""Elements of an XML text with their places.  A text that declares a document type is refused: entities
could make it grow without bound, or read other files."""

from __future__ import annotations

from collections.abc import Iterator
from xml.parsers import expat

from lagc.base.records import dataclass, field
from lagc.diagnostics.faults import Fault, Refused, Source, Span

MOST = 1_000_000  # elements


@dataclass
class Element:
    """An element, with its attributes and the elements inside."""

    source: Source
    tag: str
    attributes: dict[str, str]
    start: int
    end: int = 0  # of its first tag
    children: list[Element] = field(default_factory=list)

    @property
    def span(self) -> Span:
        return Span(self.source, self.start, self.end)

    def named(self, tag: str) -> Iterator[Element]:
        """Return the elements of this name directly inside."""
        return (child for child in self.children if child.tag == tag)

    def find(self, tag: str) -> Element | None:
        return next(self.named(tag), None)

    def need(self, tag: str) -> Element:
        """Return the first element of this name.  Raises Refused."""
        found = self.find(tag)
        if found is None:
            raise self.wrong(f"<{self.tag}> has no <{tag}>")
        return found

    def get(self, name: str, default: str | None = None) -> str:
        """Return an attribute.  Raises Refused if it is missing and has no default."""
        found = self.attributes.get(name, default)
        if found is None:
            raise self.wrong(f"<{self.tag}> has no attribute `{name}`")
        return found

    def numbers(self, name: str, count: int, default: str | None = None) -> list[float]:
        """Return the finite numbers of an attribute.  Raises Refused."""
        words = self.get(name, default).split()
        try:
            values = [float(word) for word in words]
        except ValueError:
            values = []
        if len(values) != count or not all(abs(value) < float("inf") for value in values):
            wanted = "a finite number" if count == 1 else f"{count} finite numbers"
            raise self.wrong(f"`{name}` of <{self.tag}> must be {wanted}, not `{' '.join(words)}`")
        return values

    def wrong(self, message: str, remedy: str | None = None) -> Refused:
        """Return the error for this element."""
        return Refused([Fault("LAG0707", message, self.span, remedy=remedy)])


def parse(source: Source) -> Element:
    """Return the outermost element.  Raises Refused."""
    data = source.text.encode()
    parser = expat.ParserCreate("utf-8")
    roots: list[Element] = []
    stack: list[Element] = []
    count = 0

    # expat counts bytes, places in a text are counted in characters.
    def place(index: int) -> int:
        return len(data[:index].decode(errors="replace")) if not source.text.isascii() else index

    def begin(tag: str, attributes: dict[str, str]) -> None:
        nonlocal count
        count += 1
        start = place(parser.CurrentByteIndex)
        made = Element(source, tag, attributes, start, source.text.find(">", start) + 1)
        if count > MOST:
            raise made.wrong(f"the file has more than {MOST:,} elements")
        (stack[-1].children if stack else roots).append(made)
        stack.append(made)

    # Entities are declared in a document type: without it, none can be expanded.
    def refuse(*_: object) -> None:
        start = place(parser.CurrentByteIndex)
        span = Span(source, start, min(start + len("<!DOCTYPE"), len(source.text)))
        message = "a document type is not read, since its entities could grow without bound"
        raise Refused([Fault("LAG0707", message, span, remedy="remove the declaration <!DOCTYPE ...>")])

    parser.StartElementHandler = begin
    parser.EndElementHandler = lambda _: stack.pop()
    parser.StartDoctypeDeclHandler = refuse
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        start = place(max(parser.ErrorByteIndex, 0))  # -1 in an empty text
        span = Span(source, start, min(start + 1, len(source.text)))
        message = f"this is no XML: {expat.ErrorString(error.code)}"
        raise Refused([Fault("LAG0707", message, span)]) from None
    return roots[0]

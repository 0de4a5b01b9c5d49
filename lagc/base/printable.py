"""Text that may hold anything, made harmless for a terminal, a line or a file of text.

Control characters, DEL, those that change the direction of writing and all else without a shape of its
own are written as escapes.
"""

from __future__ import annotations


def printable(text: str) -> str:
    """`text` without characters that would steer a terminal; line ends are kept."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\n" else _escape(c) for c in text)


def one_line(text: str) -> str:
    """`printable`, without line ends too."""
    return printable(text).replace("\n", "\\n")


def json_text(value: object, indent: int | None = None, encoding: str = "utf-8") -> str:
    """`value` as JSON: what is no printable character, or none of `encoding`, stands as its escape, and a
    number that is not finite as null, for JSON has no word for it."""
    import json

    text = json.dumps(_finite(value), indent=indent, ensure_ascii=False, allow_nan=False)
    if text.isascii():
        return text.replace("\x7f", "\\u007f")
    try:
        text.encode(encoding)
    except UnicodeEncodeError:
        return json.dumps(_finite(value), indent=indent).replace("\x7f", "\\u007f")
    return "".join(c if c.isprintable() or c == "\n" else json.dumps(c)[1:-1] for c in text)


def _finite(value: object) -> object:
    if isinstance(value, float):
        return value if value - value == 0.0 else None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return value


def _escape(char: str) -> str:
    code = ord(char)
    return f"\\x{code:02x}" if code < 256 else f"\\u{code:04x}" if code < 65536 else f"\\U{code:08x}"

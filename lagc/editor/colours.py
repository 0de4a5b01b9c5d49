"""Colours of `.lag` texts: one table of patterns, for TextMate (VS Code and others) and for Pygments.

`python -m lagc.editor.colours` prints the TextMate grammar. A keyword is coloured by the rule of the parser:
it is one unless the next sign can only follow a name.
"""

import json
import re
from collections.abc import Iterable

from lagc.editor import words
from lagc.syntax.lalr import AFTER_NAMES, ALWAYS, BEFORE_SIGNS

_CONTROL = ("else", "elseif", "end", "for", "if", "in", "loop", "then", "when")
_OPERATORS = ("and", "not", "or")
_BLOCKS = ("effect", "function", "model", "package", "partial", "scene", "type")
_SIGNS = frozenset("".join(AFTER_NAMES) + ";")
_BEFORE_EXPRESSIONS = ("then", "else", "elseif", "and", "or", "at", "from", "in")
_AFTER = {**BEFORE_SIGNS, **dict.fromkeys(_BEFORE_EXPRESSIONS, "(+-")}  # signs that may follow a keyword


def _keywords(chosen: Iterable[str]) -> str:
    """Return the pattern of keywords: each, unless a sign follows that can only follow a name."""
    by_signs: dict[str, list[str]] = {}
    for word in sorted(chosen):
        signs = "" if word in ALWAYS else "".join(sorted(_SIGNS - set(_AFTER.get(word, ""))))
        by_signs.setdefault(signs, []).append(word)
    patterns = [
        rf"(?:{'|'.join(found)})\b" + (rf"(?!\s*[{re.escape(signs)}])" if signs else "")
        for signs, found in by_signs.items()
    ]
    return rf"(?<![\w.])(?:{'|'.join(patterns)})"


def _words(chosen: Iterable[str], behind: str = "") -> str:
    return rf"(?<![\w.])(?:{'|'.join(sorted(chosen))})\b{behind}"


def patterns() -> list[tuple[tuple[str, ...], str]]:
    """Return the scopes of TextMate and the pattern of each rule, in the order in which they are tried; of
    several scopes, each is that of a group."""
    grouped = (*_CONTROL, *_OPERATORS, *_BLOCKS, "true", "false")
    number = r"(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
    unit = r"\[[^\[\]\n]*\]"
    return [
        (("comment.line.double-slash",), r"//.*$"),
        (("string.quoted.double",), r'"(?:[^"\\\n]|\\.)*"'),
        (("constant.numeric", "constant.other.unit"), rf"(?<![\w.])({number})(\s*{unit})?"),
        (("punctuation.section.braces.end", "constant.other.unit"), rf"(\}})(\s*{unit})?"),
        (("constant.other.unit",), rf"(?<=\bReal){unit}"),
        (("constant.language",), _words(("true", "false"))),
        (("keyword.operator.word",), _keywords(_OPERATORS)),
        (("keyword.control",), rf"\bend\s+(?:for|when)\b|{_keywords(_CONTROL)}"),
        (("storage.type.block",), _keywords(_BLOCKS)),
        (("storage.type",), _keywords(word for word in words.keywords() if word not in grouped)),
        (("support.type",), _words(words.types(), r"(?=\s+[A-Za-z_]|\s*[\[(])")),
        (("support.class",), _words(words.THINGS)),
        (("support.function",), _words((*words.FUNCTIONS, *words.ACTIONS), r"(?=\s*\()")),
        (("variable.language",), _words(words.NAMED_VALUES)),
        (("variable.other",), r"[A-Za-z_]\w*"),
        (("keyword.operator",), r"[-+*/^=<>:]+"),
    ]


def textmate() -> dict[str, object]:
    """Return the TextMate grammar."""
    rules: list[dict[str, object]] = [{"name": "comment.block.lag", "begin": r"/\*", "end": r"\*/"}]
    for scopes, pattern in patterns():
        names = [f"{scope}.lag" for scope in scopes]
        captures = {str(group): {"name": name} for group, name in enumerate(names, 1)}
        rules.append({"match": pattern, **({"captures": captures} if len(names) > 1 else {"name": names[0]})})
    return {"name": "lag", "scopeName": "source.lag", "fileTypes": ["lag"], "patterns": rules}


if __name__ == "__main__":
    print(json.dumps(textmate(), indent=1))

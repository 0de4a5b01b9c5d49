"""The lexer of `.lag` texts for Pygments, which finds it by the entry point `pygments.lexers`."""

import re
from typing import Any

from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Keyword, Name, Number, Operator, Punctuation, String, Whitespace

from lagc.editor.colours import patterns

_TOKENS = {  # by the beginning of a scope
    "comment": Comment.Single, "string": String, "constant.numeric": Number,
    "constant.other": Name.Attribute, "constant.language": Keyword.Constant,
    "keyword.operator.word": Operator.Word, "keyword.operator": Operator, "keyword.control": Keyword,
    "storage": Keyword.Declaration, "support.type": Keyword.Type, "support.class": Name.Class,
    "support.function": Name.Builtin, "variable.language": Name.Builtin.Pseudo, "variable.other": Name,
    "punctuation": Punctuation,
}  # fmt: skip


def _rule(scopes: tuple[str, ...], pattern: str) -> tuple[str, Any]:
    found = [next(token for name, token in _TOKENS.items() if scope.startswith(name)) for scope in scopes]
    return pattern, found[0] if len(found) == 1 else bygroups(*found)


class LagLexer(RegexLexer):
    """The modelling language of lagc."""

    name = "lag"
    aliases = ("lag",)
    filenames = ("*.lag",)
    flags = re.MULTILINE
    tokens = {  # noqa: RUF012
        "root": [
            (r"/\*", Comment.Multiline, "comment"),
            *(_rule(scopes, pattern) for scopes, pattern in patterns()),
            (r"\s+", Whitespace),
            (r"[(){\[\],;.]", Punctuation),
        ],
        "comment": [(r"\*/", Comment.Multiline, "#pop"), (r"[^*]+|\*", Comment.Multiline)],
    }

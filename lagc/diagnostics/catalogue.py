"""The catalogue of faults: the meaning of each code, with a wrong and a right example.

The pages of `docs/reference/messages` have a section for each code: its title, a paragraph, and after
`wrong:` and `right:` two complete models, which tests run.  The first gives the code, the second is accepted.
There are none if the fault does not come from the text of a model.
"""

import os
import re
from textwrap import indent

from lagc.base.records import dataclass

_SECTION = re.compile(
    r"""
    ^\#\#\ (LAG\d{4}):\ (.*)\n\n
    ((?:.+\n)+)
    (?:\nwrong:\n\n((?:\ {4}.*\n)+))?
    (?:\nright:\n\n((?:\ {4}.*\n)+))?
    """,
    re.MULTILINE | re.VERBOSE,
)


@dataclass(frozen=True, slots=True)
class Entry:
    title: str
    explanation: str
    wrong: str = ""
    right: str = ""

    def shown(self, code: str) -> str:
        """Return the text of the entry, with its examples indented."""
        examples = [(title, text) for title, text in (("wrong", self.wrong), ("right", self.right)) if text]
        parts = [f"{title}:\n\n{indent(text.rstrip(), '    ')}" for title, text in examples]
        return "\n\n".join([f"{code}: {self.title}", self.explanation, *parts]) + "\n"


def entries(folder: str) -> dict[str, Entry]:
    """Return every entry of the pages in `folder`, in the order of the codes."""
    found: dict[str, Entry] = {}
    for page in sorted(os.listdir(folder)):
        with open(os.path.join(folder, page), encoding="utf-8") as file:
            for code, title, paragraph, wrong, right in _SECTION.findall(file.read()):
                found[code] = Entry(title, " ".join(paragraph.splitlines()), _model(wrong), _model(right))
    return dict(sorted(found.items()))


def _model(indented: str) -> str:
    return "".join(line[4:] for line in indented.splitlines(keepends=True))

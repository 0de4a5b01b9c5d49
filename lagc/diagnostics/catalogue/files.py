"""Faults of files and of the command line (LAG07xx)."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

ENTRIES: dict[str, Entry] = {
    "LAG0701": Entry(
        "there is no such model file",
        "A model is named by the path of its file, or by the name of a model of the library, with its "
        "folder where two have the same name: `simple_pendulum`, `course/simple_pendulum`.",
    ),
    "LAG0702": Entry(
        "a model file cannot be read",
        "A model is a regular file, `-` for standard input, or a pipe that somebody writes to; else the "
        "system says why: a folder, or no permission.",
    ),
    "LAG0703": Entry("a model file is not UTF-8 text", "Save it as UTF-8; a byte order mark is allowed."),
    "LAG0704": Entry("a model file is too large", "The largest that is read has 4 MB; none is read in part."),
    "LAG0705": Entry(
        "a file has changed since the model was compiled",
        "A compiled model never changes: what is compiled of it later, as its derivatives or its C, is made "
        "of the same imports and files of numbers.  Load and compile it again for the new ones.",
    ),
    "LAG0799": Entry(
        "internal error of lagc",
        "This is never your fault: please report it, with the model.  With `-v` the details are written to a "
        "file, whose name is printed.",
    ),
}

"""Faults of files (LAG07xx) and of limits on time and memory (LAG08xx)."""

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
    "LAG0801": Entry(
        "a stage took longer than it may",
        "The message names the stage.  With `--max-time T` the whole command has that time; without it each "
        "stage of compiling has a minute and more for a large model, and a run as long as it takes "
        "(LAG0803).  `--max-time none` lets everything go on.  A run that is ended keeps what it computed.",
    ),
    "LAG0802": Entry(
        "a stage needs more memory than it may have",
        "The limit is `--max-memory SIZE`, else three quarters of the memory of the machine (4 GB at least); "
        "the system counts what is reserved, which is somewhat more than what is used.",
    ),
    "LAG0803": Entry(
        "a run would take longer than minutes",
        "How far an integration came in its first seconds tells how long it will take.  One that needs more "
        "than five minutes goes on only if told to: with `--max-time none`, or with `--max-time 2h`, when it "
        "ends then and keeps what it has.",
    ),
    "LAG0804": Entry(
        "a run would record more than memory should hold",
        "Points times states is known before the run: more than 2 GB are recorded only if allowed by "
        "`--max-memory SIZE`.  Fewer points do not make the run less accurate.",
    ),
    "LAG0805": Entry(
        "the start was not tried to its end",
        "`lagc check` tries starts as runs do, each for a minute, more for a large model; whether there is "
        "one is not known where this warning stands.  A run searches for its start as long as it takes.  "
        "With `--max-time T` the whole command has that time instead, and is ended by it (LAG0801).",
    ),
}

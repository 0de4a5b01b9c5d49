"""Faults of files (LAG07xx) and of limits on time and memory (LAG08xx)."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

ENTRIES: dict[str, Entry] = {
    "LAG0701": Entry(
        "a model file that does not exist",
        "Give the path of a model file, or the name of a library model, with its folder if two models "
        "have the same name: `simple_pendulum`, `course/simple_pendulum`.",
    ),
    "LAG0702": Entry(
        "a model file that cannot be read",
        "A model is a regular file, a pipe that another program writes to, or `-` for standard input. The "
        "message gives the reason of the operating system.",
    ),
    "LAG0703": Entry(
        "a model file that is not UTF-8 text", "Save the file as UTF-8. A byte order mark is allowed."
    ),
    "LAG0704": Entry("a model file that is too large", "The largest model file has 4 MB."),
    "LAG0705": Entry(
        "a file that has changed since the model was compiled",
        "A compiled model never changes: later stages, such as its derivatives or its C code, use the "
        "same imports and data files. Load and compile the model again to use the new files.",
    ),
    "LAG0799": Entry(
        "an internal error of lagc",
        "This is a bug in lagc, not in your model. Please report it together with the model. With `-v` "
        "the details are written to a file, and its name is printed.",
    ),
    "LAG0801": Entry(
        "a stage that took too long",
        "The message names the stage. `--max-time T` limits the whole command. Without it each stage of "
        "the compiler may take one minute, or more for a large model, and a run is limited by LAG0803. "
        "`--max-time none` removes all limits. A run that is stopped keeps what it computed.",
    ),
    "LAG0802": Entry(
        "a stage that needs too much memory",
        "The limit is `--max-memory SIZE`, by default three quarters of the memory of the machine (at "
        "least 4 GB). The system counts reserved memory, which is somewhat more than the memory in use.",
    ),
    "LAG0803": Entry(
        "a run that would take more than five minutes",
        "The progress in the first seconds predicts the duration of the run. A longer run needs your "
        "permission: `--max-time none`, or `--max-time 2h`, which stops it after that time and keeps what "
        "it computed.",
    ),
    "LAG0804": Entry(
        "a run that would record too much data",
        "The number of points times the number of states is known before the run. Recording more than 2 "
        "GB needs `--max-memory SIZE`. Fewer points do not make the run less accurate.",
    ),
    "LAG0805": Entry(
        "an initialization that was not finished",
        "`lagc check` tries the initialization of each scene for one minute, or more for a large model. "
        "This warning means that the result is not known yet; a run searches without this limit. "
        "`--max-time T` limits the whole command instead (LAG0801).",
    ),
}

"""Faults of limits (LAG08xx): what takes longer, or more memory, than it may."""

from __future__ import annotations

from lagc.diagnostics.catalogue import Entry

ENTRIES: dict[str, Entry] = {
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

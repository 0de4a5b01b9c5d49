"""The runtime, written once: all that runs and is not the equations of a model.

Kernels are Python in a small typed subset (`words`), one file a subject, with the formula and its source
as comment.  The printers of `lagc.render.kernels` make C and Python of them; what is outside the subset
is refused there with file and line.  No kernel calls one that stands after it: files in the order of
FILES, functions in that of their file.
"""

from typing import NewType

Status = NewType("Status", int)  # what a call ends with: see `statuses`
FILES = (
    "statuses", "limits", "trigonometry",
    "records", "binding", "kinds", "modes", "dense", "fallback", "damped", "rhs", "quaternions", "projection",
    "runge_kutta", "method", "check", "control", "weights", "listening",
    "enclosing", "branches", "locating", "resting", "switching", "events", "narrow", "calls", "step",
    "recording",
    "startrecords", "leastrows", "leastnorm", "startparts", "startrows", "startpairs", "startsizes",
    "starttable", "startalone", "startsteps", "startfind", "startchoice", "startsearch", "start",
)  # fmt: skip
WORDS = ("words", "sizes", "tables", "model", "tableau")  # what kernels may name
METHODS = (
    "dop853",
    "dopri5",
    "rk4",
    "bs32",
)  # folder `methods`: one file each; a number of the interface by its place
MOST_ACTS = 20  # of a clause `when` at one moment, on average: more are without end

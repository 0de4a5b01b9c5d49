"""The numbers that control a run, declared once: command line, scenes, Python and documents follow."""

from lagc.base.records import dataclass


@dataclass(frozen=True)
class RunOption:
    """A number that controls a run.  `unit` is its SI unit, `form` stands for its value in a help text.

    It is positive, or not negative if it `may_be_zero`; a `whole` one is an integer.  One that is `relative`
    to the size of the motion, as this kind of quantity, is below 1."""

    name: str
    unit: str
    form: str
    about: str
    may_be_zero: bool = False
    whole: bool = False
    relative: str = ""

    @property
    def of_scene(self) -> str:
        """Return the name in `simulate(...)` of a scene."""
        return self.name.replace("_", "")

    @property
    def of_command(self) -> str:
        """Return the option of the command line."""
        return f"--{self.name.replace('_', '-')}"


RUN_OPTIONS = {
    option.name: option
    for option in (
        RunOption("stop", "s", "T", "the end time in s or with a unit: 20, '5[min]'; default: that of the "
                  "scene, or 10 s", may_be_zero=True),
        RunOption("every", "s", "DT", "record a point every DT (by dense output; the steps do not change)"),
        RunOption("step", "s", "DT", "by hand: a fixed step size in s, instead of tolerances"),
        RunOption("max_step", "s", "DT", "the longest step in s; default: chosen for the accuracy"),
        RunOption("accuracy", "", "A", "the global relative error of each quantity; default: 1e-6",
                  relative="error"),
        RunOption("points", "", "N", "record N points; default: 501", whole=True),
        RunOption("rtol", "", "R", "by hand: the relative tolerance of a step", may_be_zero=True,
                  relative="tolerance"),
        RunOption("atol", "", "A", "by hand: the absolute tolerance of a step, for every state; default: 0",
                  may_be_zero=True),
    )
}  # fmt: skip

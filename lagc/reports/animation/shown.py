"""The content of an animation: the scene of a run, its frames and forces, and other runs as ghosts."""

from collections.abc import Callable, Sequence

from lagc.base.records import dataclass
from lagc.reports.animation.forces import Arrow, Evaluate, arrows
from lagc.reports.animation.frames import Frames, frames_of
from lagc.reports.animation.scene import Scene, infer
from lagc.semantics.model import Model
from lagc.simulation.solution import Solution


@dataclass(frozen=True)
class Source:
    """A run with its model. `again` repeats it with another number of recorded points, and `evaluate` gives
    values of expressions at times and states; without it no reactions are drawn."""

    run: Solution
    model: Model
    label: str = ""
    again: Callable[[int], Solution] | None = None
    evaluate: Evaluate | None = None


@dataclass(frozen=True)
class Shown:
    scene: Scene
    run: Solution
    frames: Frames
    arrows: list[Arrow]
    ghosts: list[tuple[str, Solution, Frames]]

    @property
    def all_frames(self) -> list[tuple[str, Frames]]:
        return [("", self.frames), *((label, frames) for label, _, frames in self.ghosts)]

    @property
    def runs(self) -> list[Solution]:
        return [self.run, *(run for _, run, _ in self.ghosts)]


def show(leader: Source, ghosts: Sequence[Source] = (), forces: bool = True) -> Shown:
    """Return what an animation of a run shows. Raises ValueError for a run without states."""
    if not leader.run.times:
        raise ValueError("a run without recorded points shows nothing")
    scene = infer(leader.model, leader.run)
    frames = frames_of(scene, leader.run, leader.again)
    acting = arrows(scene, frames, leader.evaluate) if forces else []
    others = [
        (g.label, g.run, frames_of(infer(g.model, g.run), g.run, g.again)) for g in ghosts if g.run.times
    ]
    return Shown(scene, leader.run, frames, acting, others)

"""What a leaf of the graph stands for, and what it is called."""

from __future__ import annotations

from lagc.base.records import dataclass, replace

QUANTITIES = ("energy", "kinetic", "potential", "power", "momentum", "angular_momentum")
_RATES = {"coordinate": "rate", "rate": "acceleration", "speed": "acceleration"}


@dataclass(frozen=True, slots=True)
class Symbol:
    """`kind` keeps name spaces apart; `owner` is the name of what it belongs to, `component` which of its
    components it is; `order` counts the time derivatives of what these two name."""

    kind: str
    owner: str = ""
    component: str = ""
    order: int = 0

    @property
    def turns(self) -> bool:
        """Whether it is a body rate of an orientation, or the acceleration of one."""
        return self.component != "" and self.kind in ("rate", "acceleration")

    @property
    def derivative(self) -> Symbol:
        """The symbol of its time derivative."""
        return replace(self, kind=_RATES[self.kind], order=self.order + 1)

    @property
    def base(self) -> str:
        """Its name without time derivatives."""
        owner = f"{self.kind}({self.owner})" if self.kind in QUANTITIES else self.owner
        part = f"rate.{self.component}" if self.turns else self.component
        return f"{owner}.{part}" if part else owner

    @property
    def name(self) -> str:
        return derived(self.base, self.order)


def derived(name: str, order: int = 1) -> str:
    """A name with so many time derivatives, as in the language: `der(theta)`."""
    return "der(" * order + name + ")" * order


def underived(name: str) -> str:
    """`theta` of `der(theta)`, where a person wrote it."""
    return name.removeprefix("der(").removesuffix(")") if name.startswith("der(") else name

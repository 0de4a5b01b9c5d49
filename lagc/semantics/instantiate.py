"""Instantiation of a model: inheritance, effects, loops and nested instances."""

from collections.abc import Iterable

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Span, Wrong
from lagc.diagnostics.suggest import did_you_mean, remedy_of_word
from lagc.semantics.context import Context
from lagc.semantics.names.namespace import Namespace
from lagc.semantics.names.scope import (
    DEEPEST,
    Entry,
    Environment,
    Extended,
    Indexed,
    Instance,
    Item,
    Modifier,
    Modifiers,
    Part,
    Scalar,
    Source,
    modifiers_of,
    outermost_first,
    subscripts,
)
from lagc.semantics.units import NONE
from lagc.semantics.values.evaluate import integer, integers
from lagc.syntax import tree

ELEMENTS = ("Gravity", "Particle", "Solid")  # declared like instances, but not models
_CHANGEABLE = (
    "constant", "parameter", "structural", "input", "coordinate", "speed", "discrete", "output", "instance",
    "placeholder",
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Destination:
    """The environment in which a declaration is read, its effect, and the list that receives its entries."""

    environment: Environment
    effect: str | None
    items: list[Item]


class Builder:
    """Registers the declarations of one instance and of its nested instances."""

    def __init__(
        self, context: Context, instance: Instance, modifiers: Modifiers, effect: str | None = None
    ):  # fmt: skip
        self.context = context
        self.instance = instance
        self.modifiers = modifiers
        self.effect = effect  # that holds the instance
        self.used: set[str] = set()  # modifiers with a declaration
        self.bases: list[tree.ModelDeclaration] = []  # chain of `extends`, the instance's own model first
        self.extended: Extended = {}
        self.deferred: list[tuple[tree.Declaration, Destination]] = []

    def build(self, declaration: tree.ModelDeclaration, space: Namespace) -> None:
        # First everything that needs no size; then modifiers of bases behind those from outside; then loops,
        # instances and elements, whose sizes may depend on any parameter.
        self._body_of(declaration, space)
        for name, modifier in outermost_first(declaration, self.extended):
            self.modifiers.setdefault(name, []).append(modifier)
        for job in self.deferred:
            self.context.attempt(self._unfold, *job)
        for name, given in self.modifiers.items():
            if name not in self.used:
                self.context.report(self._unknown_modifier(name, given[0]))

    # -- what is there at once -------------------------------------------------------------

    def _body_of(self, declaration: tree.ModelDeclaration, space: Namespace) -> None:
        if any(base is declaration for base in self.bases):
            raise Wrong("LAG0205", f"`{declaration.name}` extends itself", declaration.name_span)
        if len(self.bases) >= DEEPEST:
            raise Wrong(
                "LAG0218", f"models extend one another more than {DEEPEST} levels deep", declaration.name_span
            )
        # A model that is extended on two paths is there once.
        if id(declaration) in self.extended:  # already extended on another path
            return
        self.extended[id(declaration)] = []
        self.bases.append(declaration)
        inner = self.context.importer.inside(declaration, space)
        self._register(
            declaration.body, Destination(Environment(self.instance, inner), self.effect, self.instance.items)
        )
        self.bases.pop()

    def _register(self, body: Iterable[tree.Declaration], destination: Destination) -> None:
        for declaration in body:
            self.context.attempt(self._register_one, declaration, destination)

    def _register_one(self, d: tree.Declaration, destination: Destination) -> None:
        # A declaration of an effect that is not used has a name, for the message, and no entry. Loops and
        # instances wait until all sizes are known.
        excluded = self._excluding_effect(d)
        if excluded is not None:
            for name in names_of(d):
                self.instance.unused.setdefault(name, f"is left out because the effect `{excluded}` is used")
        elif isinstance(d, tree.Quantities):
            for declarator in d.declarators:
                self._enter(d.kind, declarator.name, d, declarator, destination)
        elif isinstance(d, tree.FunctionDeclaration):
            self._enter("function", d.name, d, d, destination)
        elif isinstance(d, tree.Construct | tree.Load | tree.Constraint):
            self._construct(d, destination)
        elif isinstance(d, tree.Placeholder):
            self._enter("placeholder", d.name, d, d, destination)
        elif isinstance(d, tree.Initial):
            self.instance.conditions += [(condition, destination.environment) for condition in d.conditions]
        elif isinstance(d, tree.Effect):
            self._effect(d, destination)
        elif isinstance(d, tree.Extends):
            self._extends(d, destination.environment)
        elif isinstance(d, tree.ForLoop | tree.Instance):
            self._defer(d, destination)
        elif isinstance(d, tree.When):
            self.context.whens.append((d, destination.environment, destination.effect))
        elif isinstance(d, tree.Start | tree.Simulate):
            message = "this is only allowed in a scene"
            remedy = "write it between `scene name uses ...` and `end name;`"
            raise Wrong("LAG0221", message, d.span, remedy)

    def _excluding_effect(self, d: tree.Declaration) -> str | None:
        for name in getattr(d, "unless", ()):
            # A name of `unless` that is no effect is reported later, when all effects are known.
            if self._uses(name.name):
                return str(name.name)
            self.context.mentioned.append((name, self.instance.path))
        return None

    def _uses(self, name: str) -> bool:
        return self.context.uses.has_beside(self.instance.path, name)

    def _enter(
        self, kind: str, name: str, d: tree.Declaration, source: Source, destination: Destination
    ) -> Entry:
        self.context.grow(source.span)
        entry = Entry(kind, name, d, source, destination.environment, destination.effect)
        first = self.instance.entries.get(name)
        if first is not None:
            raise self._declared_twice(name, entry.span, first.span)
        # The list of modifiers is shared: models that extend this one add to it.
        entry.modifiers = self.modifiers.setdefault(name, [])  # filled later by models that extend this one
        self.used.add(name)
        self.instance.entries[name] = entry
        destination.items.append(entry)
        return entry

    def _declared_twice(self, name: str, span: Span, first: Span) -> Wrong:
        return Wrong("LAG0202", f"`{name}` is declared twice", span, related=((first, "first here"),))

    def _construct(self, d: tree.Construct | tree.Load | tree.Constraint, destination: Destination) -> None:
        kind = "constraint" if isinstance(d, tree.Constraint) else d.kind
        if not d.index:
            entry = self._enter(kind, d.name, d, d, destination)
            if kind == "joint":
                self._coordinates(entry, destination)
            return
        # Elements `b[1]`, `b[2]` of an indexed name have one container, which is entered with the first of
        # them.
        container = self.instance.entries.get(d.name)
        if container is None:
            container = self._enter(kind, d.name, d, d, replace(destination, items=[]))
            container.elements = {}
            container.state, container.value = "done", Indexed(container)
        if container.elements is None or container.kind != kind:
            raise self._declared_twice(d.name, d.name_span, container.span)
        self._defer(d, destination)

    def _effect(self, d: tree.Effect, destination: Destination) -> None:
        path = self.instance.path + d.name
        if path in self.context.effects:
            raise self._declared_twice(d.name, d.name_span, self.context.effects[path].name_span)
        self.context.effects[path] = d
        self.instance.effects[d.name] = d
        for declaration in d.body:
            if isinstance(
                declaration, tree.Extends | tree.Scene | tree.Effect | tree.Initial | tree.ModelDeclaration
            ):
                raise Wrong("LAG0221", "this is not allowed in an effect", declaration.span)
        # An unused effect leaves names behind, so that a value given to one of them is explained.
        if self._uses(d.name):
            self._register(d.body, replace(destination, effect=d.name))
            return
        for declaration in d.body:
            for name in names_of(declaration):
                self.instance.unused.setdefault(
                    name, f"belongs to the effect `{d.name}`, which the scene does not use"
                )
                self.used.add(name)

    def _extends(self, d: tree.Extends, environment: Environment) -> None:
        found, space = environment.space.find(d.path, d.path_span, "model")
        if not isinstance(found, tree.ModelDeclaration):
            raise Wrong("LAG0204", f"`{'.'.join(d.path)}` is not a model", d.path_span)
        given = modifiers_of(d.arguments, environment)
        self.extended[id(self.bases[-1])].append((found, given))
        self._body_of(found, space)

    def _defer(self, d: tree.Declaration, destination: Destination) -> None:
        """Reserve the place of a declaration whose sizes are evaluated later."""
        # The place in the order of the text is kept; the declarations come into it when sizes are known.
        place: list[Item] = []
        destination.items.append(place)
        if isinstance(d, tree.Instance):
            for declarator in d.declarators:
                known = self.instance.entries.get(declarator.name)
                if known is not None:
                    raise self._declared_twice(declarator.name, declarator.name_span, known.span)
                self._enter("instance", declarator.name, d, declarator, replace(destination, items=[]))
        self.deferred.append((d, replace(destination, items=place)))

    # -- what is unfolded when sizes can be asked for -------------------------------------------

    def _unfold(self, d: tree.Declaration, destination: Destination) -> None:
        if isinstance(d, tree.ForLoop):
            self._loop(d, destination)
        elif isinstance(d, tree.Instance):
            for declarator in d.declarators:
                entry = self.instance.entries[declarator.name]
                if entry.source is declarator and not self.context.attempt(
                    self._instance, d, entry, destination
                ):
                    entry.state = "poisoned"
        elif isinstance(d, tree.Construct | tree.Load | tree.Constraint):
            self._element(d, destination)

    def _loop(self, d: tree.ForLoop, destination: Destination) -> None:
        for declaration in d.body:
            if isinstance(
                declaration,
                tree.Construct | tree.Load | tree.Constraint | tree.ForLoop | tree.Initial | tree.When,
            ):
                continue
            before = "declare an array before the loop, `coordinate Angle th[n];`"
            remedy = before if isinstance(declaration, tree.Quantities) else None
            raise Wrong("LAG0221", "this is not allowed in a loop", declaration.span, remedy)
        # The body is registered once for each number, with the loop variable bound; inner loops unfold at
        # once, as they see it.
        for number in integers(self.context, d.range, destination.environment):
            self.context.grow(d.span)
            value = Scalar(self.context.graph.const(number), None if number == 0 else NONE)
            inner = replace(destination, environment=destination.environment.bind({d.variable: value}))
            first = len(self.deferred)
            for declaration in d.body:
                self._register_one(declaration, inner)
            jobs, self.deferred[first:] = self.deferred[first:], []
            for job in jobs:
                self._unfold(*job)

    def _element(self, d: tree.Construct | tree.Load | tree.Constraint, destination: Destination) -> None:
        container = self.instance.entries[d.name]
        assert container.elements is not None
        numbers = tuple([integer(self.context, i, destination.environment, "a subscript") for i in d.index])
        self.context.grow(d.span)
        entry = Entry(container.kind, d.name, d, d, destination.environment, destination.effect)
        entry.path += f"[{','.join(str(n) for n in numbers)}]"
        entry.subscript = numbers
        first = container.elements.get(numbers)
        if first is not None:
            raise self._declared_twice(entry.path, d.name_span, first.span)
        container.elements[numbers] = entry
        destination.items.append(entry)
        if entry.kind == "joint":
            self._coordinates(entry, destination)

    def _coordinates(self, joint: Entry, destination: Destination) -> None:
        """Enter the coordinates of a joint as members: `knee.angle`."""
        from lagc.semantics.joints import coordinates_of

        self.context.has_joints = True
        joint.inner = coordinates_of(joint, self.instance)
        destination.items.append([*joint.inner])

    def _instance(self, d: tree.Instance, entry: Entry, destination: Destination) -> None:
        source = entry.source
        assert isinstance(source, tree.Declarator)
        space = entry.environment.space
        # `Solid crank(...)` and `Gravity field;` look like instances and are declarations of their own.
        if len(d.type.path) == 1 and d.type.path[0] in ELEMENTS and space.lookup(d.type.path[0]) is None:
            if source.dimensions:
                message = f"an array of `{d.type.path[0]}` cannot be declared this way"
                remedy = "write `body b[i] = ...;` in a loop"
                raise Wrong("LAG0221", message, source.span, remedy)
            entry.kind = "gravity" if d.type.path[0] == "Gravity" else "body"
            destination.items.append(entry)
            return
        try:
            model, where = self._model_of(d, space)
        except Wrong as wrong:
            if wrong.fault.code != "LAG0203" or not _is_quantity(d):
                raise
            entry.kind = "quantity"  # without its kind, reported when the values that it uses are known
            destination.items.append(entry)
            return
        if source.value is not None:
            raise Wrong("LAG0221", "an instance of a model has no value", source.value.span)
        # Modifications from outside go before those of the declaration, the outermost first.
        modifiers = modifiers_of(source.arguments, entry.environment)
        for modifier in reversed(entry.modifiers):  # the outermost last, because the last goes first
            if modifier.argument.value is not None:
                message = f"`{entry.name}` is an instance of a model and has no value"
                raise Wrong("LAG0209", message, modifier.argument.span)
            for name, outer in modifiers_of(modifier.argument.arguments, modifier.environment).items():
                modifiers[name] = [*outer, *modifiers.get(name, [])]
        # One instance is a part; of an array each element takes its share of arrays in modifications.
        sizes = [integer(self.context, s, entry.environment, "a size") for s in source.dimensions]
        if not sizes:
            part = self._nested_instance(model, where, entry.path + ".", modifiers, destination)
            entry.state, entry.value = "done", part
            return
        entry.elements = {}
        entry.state, entry.value = "done", Indexed(entry)
        for numbers in subscripts(sizes, source.span):
            element = Entry("instance", entry.name, d, source, entry.environment, destination.effect)
            element.path = f"{entry.path}[{','.join(str(n) for n in numbers)}]"
            entry.elements[numbers] = element
            chosen = {
                n: [Modifier(m.argument, m.environment, numbers) for m in outer]
                for n, outer in modifiers.items()
            }
            element.state, element.value = (
                "done",
                self._nested_instance(model, where, element.path + ".", chosen, destination),
            )

    def _model_of(self, d: tree.Instance, space: Namespace) -> tuple[tree.ModelDeclaration, Namespace]:
        try:
            model, where = space.find(d.type.path, d.type.span, "model or type")
        except Wrong as wrong:
            name = d.type.path[-1]
            remedy = remedy_of_word("models", name) or remedy_of_word("types", name) or wrong.fault.remedy
            remedy = remedy or did_you_mean(name, ELEMENTS)
            remedy = remedy or f"declare it, `model {name} ... end {name};`, or import its file"
            raise Wrong(wrong.fault.code, wrong.fault.message, wrong.fault.span, remedy) from None
        if not isinstance(model, tree.ModelDeclaration):
            raise Wrong("LAG0204", f"`{'.'.join(d.type.path)}` is not a model", d.type.span)
        if model.partial:
            message = f"`{model.name}` is partial; it can only be extended"
            related = ((model.name_span, "declared here"),)
            raise Wrong("LAG0211", message, d.type.span, related=related)
        return model, where

    def _nested_instance(
        self,
        model: tree.ModelDeclaration,
        space: Namespace,
        path: str,
        modifiers: Modifiers,
        destination: Destination,
    ) -> Part:
        above: Instance | None = self.instance
        while above is not None:
            if above.declaration is model:
                raise Wrong("LAG0205", f"`{model.name}` contains itself", model.name_span)
            above = above.parent
        if self.instance.depth >= DEEPEST:
            raise Wrong("LAG0218", f"instances are nested more than {DEEPEST} levels deep", model.name_span)
        inner = instantiate(
            self.context, model, space, path, modifiers, self.instance, destination.effect
        )  # fmt: skip
        destination.items.append(inner.items)
        self.context.conditions += inner.conditions
        return Part(inner)

    def _unknown_modifier(self, name: str, modifier: Modifier) -> Wrong:
        from lagc.semantics.values.members import MOST_NAMED  # where there is a fault

        owner = self.instance.declaration.name
        span = modifier.argument.name_span or modifier.argument.span
        known = [n for n, e in self.instance.entries.items() if e.kind in _CHANGEABLE]
        remedy = did_you_mean(name, known)
        if remedy is None and known:
            remedy = f"it has {', '.join(f'`{n}`' for n in known[:MOST_NAMED])}"
        return Wrong("LAG0209", f"`{owner}` has no `{name}`", span, remedy)


def _is_quantity(d: tree.Instance) -> bool:
    from lagc.semantics.names.undeclared import quantity_of  # where there is a fault

    return quantity_of(d.type.path) is not None


def instantiate(
    context: Context,
    declaration: tree.ModelDeclaration,
    space: Namespace,
    path: str,
    modifiers: Modifiers,
    parent: Instance | None,
    effect: str | None = None,
) -> Instance:
    """Return the instance of a model under `path` ("" for the main model)."""
    context.grow(declaration.name_span)
    instance = Instance(path, declaration, parent, 0 if parent is None else parent.depth + 1)
    Builder(context, instance, modifiers, effect).build(declaration, space)
    return instance


def names_of(d: tree.Declaration) -> list[str]:
    """Return the names that a declaration declares."""
    if isinstance(d, tree.Quantities | tree.Instance):
        return [declarator.name for declarator in d.declarators]
    if isinstance(d, tree.ForLoop):
        return [name for inner in d.body for name in names_of(inner)]
    named = tree.Construct | tree.Placeholder | tree.Load | tree.Constraint | tree.FunctionDeclaration
    if isinstance(d, named):
        return [d.name]
    return []

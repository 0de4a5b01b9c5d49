"""Choice of the model and the scene, and the values that the scene and the command give.

The last part lists all variants of a file that can be checked: its models, their scenes, and effects that no
scene uses.
"""

from collections.abc import Iterator, Mapping, Sequence

from lagc.base.records import dataclass, replace
from lagc.diagnostics.faults import Fault, Source, Span, Wrong
from lagc.diagnostics.suggest import did_you_mean
from lagc.semantics.context import Context, Given, Points
from lagc.semantics.names.namespace import Importer, Namespace
from lagc.semantics.names.scope import DEEPEST, Environment, Instance, Uses, keys, without_subscripts
from lagc.semantics.values.evaluate import integer
from lagc.symbolic.leaves import derived, underived
from lagc.syntax import tree
from lagc.syntax.tree import Declaration, ModelDeclaration, Package, Scene, Tree

MOST_LISTED = 12  # effects in a message

Numbers = Mapping[str, "float | tuple[float, str | None]"]
Inputs = Mapping[str, "Source | Points"]


@dataclass(frozen=True, slots=True)
class Setting:
    """The chosen scene, its effects after those that the command adds and removes, and notes on the
    choice."""

    scene: tree.Scene | None
    name: str
    names: tuple[str, ...]
    uses: Uses
    notes: tuple[str, ...]


def choose_model(
    file: tree.Tree, space: Namespace, wanted: str | None
) -> tuple[tree.ModelDeclaration, Namespace]:
    """Return the model `wanted`, or else the last one of the file that is not partial, or one in a package.
    Raises Wrong."""
    if wanted is not None:
        nowhere = Span(file.source, 0, 0)
        try:
            found, where = space.find(tuple(wanted.split(".")), nowhere, "model")
        except Wrong as wrong:
            remedy = _which_model(wanted, file) or wrong.fault.remedy
            raise Wrong("LAG0215", wrong.fault.message, None, remedy) from None
        if not isinstance(found, tree.ModelDeclaration):
            raise Wrong("LAG0215", f"`{wanted}` is not a model", None, _which_model(wanted, file))
        if found.partial:
            raise Wrong("LAG0211", f"`{wanted}` is partial; it can only be extended", found.name_span)
        return found, where
    # Without a name: the last model of the file, since it may be made of those before it.
    models = [d for d in file.declarations if isinstance(d, tree.ModelDeclaration)]
    whole = [m for m in models if not m.partial]
    if whole:
        return whole[-1], space
    inner = models_of(file.declarations)
    if inner:  # in packages
        return choose_model(file, space, inner[-1])
    if models:
        message = f"`{models[-1].name}` is partial, and the file has no other model"
        raise Wrong("LAG0211", message, models[-1].name_span)
    start = Span(file.source, 0, min(1, len(file.source.text)))
    raise Wrong("LAG0215", "the file has no model", start, "write `model Name ... end Name;`")


def models_of(declarations: Sequence[tree.Declaration], path: str = "") -> list[str]:
    """Return the full names of the models that can be chosen."""
    found: list[str] = []
    for d in declarations:
        if isinstance(d, tree.ModelDeclaration) and not d.partial:
            found.append(path + d.name)
        elif isinstance(d, tree.Package):
            found += models_of(d.body, f"{path}{d.name}.")
    return found


def _which_model(wanted: str, file: tree.Tree) -> str | None:
    known = models_of(file.declarations)
    listed = f"the models are: {', '.join(known)}" if known else None
    return did_you_mean(wanted, known) or listed


def scenes_of(
    context: Context,
    model: tree.ModelDeclaration,
    space: Namespace,
    depth: int = 0,
    seen: set[int] | None = None,
) -> dict[str, tree.Scene]:
    """Return the scenes of a model, its own first, then inherited ones; models in `seen` are skipped.  Raises
    Wrong."""
    seen = set() if seen is None else seen
    if id(model) in seen:
        return {}
    seen.add(id(model))
    scenes: dict[str, tree.Scene] = {}
    inner = context.importer.inside(model, space)
    for declaration in model.body:
        if isinstance(declaration, tree.Scene):
            if declaration.name in scenes:
                message = f"the scene `{declaration.name}` is declared twice"
                related = ((scenes[declaration.name].name_span, "first here"),)
                context.report(Wrong("LAG0202", message, declaration.name_span, related=related))
                continue
            scenes[declaration.name] = declaration
    for declaration in model.body:
        # Own scenes hide inherited ones of the same name.
        if isinstance(declaration, tree.Extends) and depth < DEEPEST:
            base, where = inner.find(declaration.path, declaration.path_span, "model")
            if isinstance(base, tree.ModelDeclaration):
                for name, scene in scenes_of(context, base, where, depth + 1, seen).items():
                    scenes.setdefault(name, scene)
    return scenes


def choose_scene(
    scenes: Mapping[str, tree.Scene], wanted: str | None, added: Sequence[str], removed: Sequence[str]
) -> Setting:
    """Return the scene `wanted`, or else the first. Raises Wrong if the scene does not exist, or if an effect
    is both added and removed."""
    notes: list[str] = []
    if wanted is None and scenes:
        wanted = next(iter(scenes))
        if len(scenes) > 1:
            notes.append(f"no scene was chosen; the first one is used: {wanted}")
    elif wanted is None or (wanted == "default" and not scenes):
        wanted = "default"
    scene = scenes.get(wanted)
    if scene is None and (scenes or wanted != "default"):
        listed = f"the scenes are: {', '.join(scenes)}" if scenes else "the model has no scenes"
        remedy = did_you_mean(wanted, scenes) or listed
        raise Wrong("LAG0215", f"there is no scene `{wanted}`", None, remedy)
    both = [e for e in added if e in removed]
    if both:
        raise Wrong("LAG0215", f"the effect `{both[0]}` is both added and left out", None)
    named = frozenset([n.name for n in scene.uses] if scene else ())
    names = tuple(scenes) or ("default",)
    return Setting(scene, wanted, names, Uses(named, frozenset(added), frozenset(removed)), tuple(notes))


def read_values(context: Context, setting: Setting, environment: Environment) -> None:
    """Record the parameter values of the scene with literal subscripts; array sizes may depend on them.
    `read_rest` records the others."""
    for d in setting.scene.body if setting.scene else ():
        if isinstance(d, tree.Quantities):
            if d.type is not None:
                context.attempt(_refuse_type, d.type)
            for declarator in d.declarators:
                if _is_plain(declarator):
                    context.attempt(_parameter, context, declarator, environment)


def read_rest(context: Context, setting: Setting, environment: Environment) -> dict[str, float]:
    """Record the other values of the scene, and return the settings of its `simulate`."""
    if setting.scene is None:
        return {}
    from lagc.semantics.requests import Settings  # loaded where there is a scene

    settings = Settings(context, environment)
    for d in setting.scene.body:
        if isinstance(d, tree.Quantities):
            for declarator in d.declarators:
                if not _is_plain(declarator):
                    context.attempt(_parameter, context, declarator, environment)
        elif isinstance(d, tree.Start):
            context.attempt(_start, context, d, environment)
        elif isinstance(d, tree.Simulate):
            settings.read(d)
    return settings.numbers()


def _refuse_type(type_name: tree.TypeName) -> None:
    message = "a scene only changes values; the type is declared in the model"
    remedy = "leave out the type"
    raise Wrong("LAG0221", message, type_name.span, remedy)


def _is_plain(declarator: tree.Declarator) -> bool:
    """Return whether all subscripts are literal numbers."""
    found = [*declarator.dimensions]
    e = declarator.within
    while isinstance(e, tree.Member | tree.Index):
        if isinstance(e, tree.Index):
            found += e.indices
        e = e.base
    return all(isinstance(index, tree.Number) for index in found)


def _parameter(context: Context, declarator: tree.Declarator, environment: Environment) -> None:
    if declarator.value is None:
        raise Wrong("LAG0210", f"the parameter `{declarator.name}` needs a value here", declarator.span)
    plain = tree.Name(declarator.name, declarator.name_span)
    name = target_text(context, declarator.within or plain, environment)
    if declarator.dimensions:
        name += subscript_text(context, declarator.dimensions, environment)
    given = Given(name, declarator.value, environment, span=declarator.name_span)
    _give(context, context.parameters, name, given)


def _start(context: Context, d: tree.Start, environment: Environment) -> None:
    inner = _of_rate(d.target)
    owner = target_text(context, inner or d.target, environment)
    name = owner if inner is None else derived(owner)
    _give(context, context.starts, name, Given(owner, d.value, environment, span=d.target.span))


def _of_rate(e: tree.Expression) -> tree.Expression | None:
    """Return `x` for `der(x)`."""
    if not isinstance(e, tree.Call) or not isinstance(e.function, tree.Name):
        return None
    return e.arguments[0].value if e.function.name == "der" and len(e.arguments) == 1 else None


def _give(context: Context, table: dict[str, Given], name: str, given: Given) -> None:
    """Record a value; one of the command overrides that of the scene.  Raises Wrong if the scene gives
    two."""
    first = table.get(name)
    if first is not None and first.span is not None:
        related = ((first.span, "first here"),)
        raise Wrong("LAG0209", f"`{name}` is given twice", given.span, related=related)
    table.setdefault(name, given)


def subscript_text(context: Context, indices: Sequence[tree.Expression], environment: Environment) -> str:
    """Return subscripts as text: `[2,1]`.  Raises Wrong."""
    return f"[{','.join(str(integer(context, i, environment, 'a subscript')) for i in indices)}]"


def target_text(context: Context, e: tree.Expression, environment: Environment) -> str:
    """Return the full name of the target of `start`: `theta`, `der(a.th[2])`.  Raises Wrong."""
    if isinstance(e, tree.Name):
        return e.name
    if isinstance(e, tree.Member):
        return f"{target_text(context, e.base, environment)}.{e.name}"
    if isinstance(e, tree.Index):
        return target_text(context, e.base, environment) + subscript_text(context, e.indices, environment)
    inner = _of_rate(e)
    if inner is not None:
        return derived(target_text(context, inner, environment))
    remedy = "write `start x = ...;` or `start der(x) = ...;`"
    if isinstance(e, tree.Call) and e.function.span.text != "der":
        remedy = f"write `start {e.function.span.text} = ...;`"
    raise Wrong("LAG0224", "`start` sets a coordinate or its rate", e.span, remedy)


def read_inputs(context: Context, inputs: Inputs, environment: Environment) -> None:
    """Record the inputs of the command or a Python caller; their data files may be anywhere. Raises Refused
    if a text is not an expression."""
    from lagc.syntax.parse import parse_expression

    for name, given in inputs.items():
        plain = "".join(name.split())
        if isinstance(given, Source):
            context.importer.free.append(given)
            expression = parse_expression(given)
            context.parameters[plain] = Given(plain, expression, environment)
        else:
            context.parameters[plain] = Given(plain, points=given)


def read_command(context: Context, parameters: Numbers | None, starts: Numbers | None) -> None:
    """Record the values of the command or a Python caller; they override those of the scene."""
    for table, given in ((context.parameters, parameters), (context.starts, starts)):
        for name, value in (given or {}).items():
            number, unit = value if isinstance(value, tuple) else (value, None)
            plain = "".join(name.split())
            table[plain] = Given(underived(plain), number=float(number), unit=unit)


def _effects(name: str, context: Context) -> str:
    """Return a remedy for an effect that does not exist."""
    if not context.effects:
        own = name.rpartition(".")[2].partition("[")[0]
        return f"the model has no effects; declare one with `effect {own} ... end {own};`"
    whole = without_subscripts(name)
    elements = [path for path in context.effects if whole != name and without_subscripts(path) == whole]
    listed = ", ".join(f"`{path}`" for path in (elements or [*context.effects])[:MOST_LISTED])
    if elements:
        return f"the model has {listed}"
    known = [*context.effects, *(path.rpartition(".")[2] for path in context.effects)]
    return did_you_mean(name, known) or f"the model has {listed}"


def check_effects(context: Context, setting: Setting) -> None:
    """Report every named effect that is unknown, and every required or excluded combination."""
    known = {key for path in context.effects for key in keys(path)}
    named = list(setting.scene.uses) if setting.scene else []
    named += [n for e in context.effects.values() for n in (*e.requires, *e.excludes)]
    named += [n for n, _ in context.mentioned]
    # Names of the text have a place; those of the command line have none, and are reported if the text does
    # not name them too.
    written = {n.name for n in named}
    for name in named:
        if name.name not in known:
            context.report(
                Wrong("LAG0212", f"there is no effect `{name.name}`", name.span, _effects(name.name, context))
            )
    for text in sorted(setting.uses.mentioned - known - written):
        context.report(Wrong("LAG0212", f"there is no effect `{text}`", None, _effects(text, context)))
    for path, effect in context.effects.items():
        if not setting.uses.has(path):
            continue
        for other in effect.requires:
            if other.name in known and not setting.uses.has_beside(path[: path.rfind(".") + 1], other.name):
                message = (
                    f"the effect `{path}` requires `{other.name}`, which the scene "
                    f"`{setting.name}` does not use"
                )
                remedy = f"add it: `uses ..., {other.name}`"
                related = _scene_place(setting, (path,))
                context.report(Wrong("LAG0213", message, other.span, remedy, related))
        for other in effect.excludes:
            if setting.uses.has_beside(path[: path.rfind(".") + 1], other.name):
                message = (
                    f"the effects `{path}` and `{other.name}` exclude each other, and the scene "
                    f"`{setting.name}` uses both"
                )
                remedy = "leave one of them out"
                related = _scene_place(setting, (path, other.name))
                context.report(Wrong("LAG0213", message, other.span, remedy, related))


def _scene_place(setting: Setting, effects: Sequence[str]) -> tuple[tuple[Span, str], ...]:
    """Return the places where the scene names these effects."""
    names = setting.scene.uses if setting.scene else ()
    return tuple((n.span, "used here") for n in names if n.name in {key for e in effects for key in keys(e)})


_SETTINGS = {"StopTime": "stop", "Tolerance": "accuracy", "Interval": "every"}  # of `experiment`


def unused_effects(
    file: tree.Tree, instance: Instance, setting: Setting, scenes: Mapping[str, tree.Scene]
) -> list[Fault]:
    """Return a warning for each effect of the main model that no scene of the file uses."""
    known = [*scenes.values(), *(d for d, _ in _within(file.declarations) if isinstance(d, tree.Scene))]
    used = {name.name for scene in known for name in scene.uses} | setting.uses.mentioned
    left = {n: e for n, e in instance.effects.items() if n not in used and e.span.source is file.source}
    first = next(iter(scenes.values()), None)
    uses = ", ".join([name.name for name in first.uses] if first else [])
    found = []
    for name, effect in left.items():
        listed = f"{uses}, {name}" if uses else name if first else ", ".join(left)
        begin = f"scene {first.name if first else 'lab'} uses {listed}"
        remedy = f"write `{begin}{' ...' if first and first.body else ';'}`, or run with `--with {name}`"
        message = f"no scene uses the effect `{name}`, which has no part in the motion"
        found.append(Fault("LAG0230", message, effect.name_span, remedy=remedy, severity="warning"))
    return found


def ignored_annotations(file: tree.Tree) -> list[Fault]:
    """Return a warning for each annotation, which has no effect."""
    return [
        Fault("LAG0231", "an annotation has no effect", d.span, remedy=_instead(d, body), severity="warning")
        for d, body in _within(file.declarations)
        if isinstance(d, tree.Annotation)
    ]


def _instead(annotation: tree.Annotation, body: Sequence[tree.Declaration]) -> str:
    """Return the settings to write for `annotation(experiment(StopTime = 10))`."""
    for argument in annotation.arguments:
        call = argument.value
        if isinstance(call, tree.Call) and call.function.span.text == "experiment":
            settings = [
                f"{_SETTINGS[a.name]} = {a.value.span.text}"
                for a in call.arguments
                if a.name in _SETTINGS and a.value is not None
            ]
            if settings:
                simulate = f"simulate({', '.join(settings)});"
                scene = next((d for d in body if isinstance(d, tree.Scene)), None)
                if scene is None:
                    return f"write `scene lab {simulate} end lab;`"
                return f"write `{simulate}` in the scene `{scene.name}`"
    return "delete it"


def _within(
    declarations: Sequence[tree.Declaration],
) -> Iterator[tuple[tree.Declaration, Sequence[tree.Declaration]]]:
    """Yield all declarations of a file, each with those beside it."""
    for d in declarations:
        yield d, declarations
        if isinstance(d, tree.ModelDeclaration | tree.Package | tree.Effect | tree.Scene):
            yield from _within(d.body)


@dataclass(frozen=True, slots=True)
class Variant:
    """One choice of model, scene and effects; None leaves the choice to `resolve`."""

    model: str | None
    scene: str | None
    with_effects: tuple[str, ...] = ()
    without_effects: tuple[str, ...] = ()
    alone: tuple[str, ...] = ()  # effects of the scene that an unused effect does not need


def variants(file: tree.Tree, model: str | None = None, roots: Sequence[str] = ()) -> list[Variant]:
    """Return every scene of every model of the file (or of `model`), and each unused effect in the first
    scene. An unused effect comes with the effects it requires.  A model that other models extend or contain,
    or that has placeholders, is only checked within others, since it may be incomplete, unless it is the one
    that `choose_model` returns.  Names that cannot be found are skipped: `resolve` reports them."""
    importer = Importer(file.source, tuple(roots))
    space = Namespace(file.declarations, None, importer)
    models = list(_models(file.declarations, space, ""))
    main = next((d for _, d, where in reversed(models) if where is space), models[-1][1] if models else None)
    parts = set(_parts(file.declarations))
    found: list[Variant] = []
    for name, declaration, where in models:
        open_ = any(isinstance(d, tree.Placeholder) for d in declaration.body)
        whole = declaration is main or (declaration.name not in parts and not open_)
        if name == model or (model is None and whole):
            found += _of_model(name, declaration, where)
    return found or [Variant(model, None)]


def _parts(declarations: Sequence[tree.Declaration]) -> Iterator[str]:
    """Yield the names of the models that others extend or contain."""
    for d in declarations:
        if isinstance(d, tree.Extends):
            yield d.path[-1]
        elif isinstance(d, tree.Instance):
            yield d.type.path[-1]
        elif isinstance(d, tree.ModelDeclaration | tree.Package | tree.Effect):
            yield from _parts(d.body)


def _models(
    declarations: Sequence[tree.Declaration], space: Namespace, path: str
) -> Iterator[tuple[str, tree.ModelDeclaration, Namespace]]:
    """Yield the non-partial models of a file and its packages, with their full names."""
    for d in declarations:
        if isinstance(d, tree.ModelDeclaration) and not d.partial:
            yield path + d.name, d, space
        elif isinstance(d, tree.Package):
            yield from _models(d.body, space.importer.inside(d, space), f"{path}{d.name}.")


def _of_model(name: str, declaration: tree.ModelDeclaration, space: Namespace) -> Iterator[Variant]:
    scenes: dict[str, tree.Scene] = {}
    effects: dict[str, tree.Effect] = {}
    for inner in _declarations(declaration, space, 0, set()):
        if isinstance(inner, tree.Scene):
            scenes.setdefault(inner.name, inner)
        elif isinstance(inner, tree.Effect):
            effects.setdefault(inner.name, inner)
    yield from (Variant(name, scene) for scene in scenes or (None,))
    first = next(iter(scenes), None)
    used = {name.name for scene in scenes.values() for name in scene.uses}
    for effect in effects.values():
        if effect.name not in used:
            wanted = _required_effects(effect, effects)
            excluded = {e.name for w in wanted if w in effects for e in effects[w].excludes}
            excluded |= {n for n, e in effects.items() if any(x.name in wanted for x in e.excludes)}
            others = [n.name for n in scenes[first].uses] if first is not None else []
            alone = tuple(n for n in others if n not in wanted and n not in excluded)
            yield Variant(name, first, tuple(wanted), tuple(sorted(excluded - set(wanted))), alone)


def _required_effects(effect: tree.Effect, effects: dict[str, tree.Effect]) -> list[str]:
    wanted = [effect.name]
    for name in wanted:  # the list grows
        if name in effects:
            wanted += [r.name for r in effects[name].requires if r.name not in wanted]
    return wanted


def _declarations(
    declaration: tree.ModelDeclaration, space: Namespace, depth: int, seen: set[int]
) -> Iterator[tree.Declaration]:
    """Yield the declarations of a model, then inherited ones; models in `seen` are skipped."""
    if id(declaration) in seen:
        return
    seen.add(id(declaration))
    yield from declaration.body
    inner = space.importer.inside(declaration, space)
    for base in declaration.body:
        if isinstance(base, tree.Extends) and depth < DEEPEST:
            try:
                found, where = inner.find(base.path, base.path_span, "model")
            except Wrong:
                continue
            if isinstance(found, tree.ModelDeclaration):
                yield from _declarations(found, where, depth + 1, seen)


class ByScene:
    """A tree that is split by scenes once, so that checking n scenes does not look at each of them n
    times."""

    def __init__(self, tree: Tree):
        self.tree = tree
        self.body = _Body(tree.declarations)

    def only(self, name: str) -> Tree:
        """Return the tree without the other scenes of its models."""
        return replace(self.tree, declarations=self.body.only(name))


class _Body:
    def __init__(self, declarations: Sequence[Declaration]):
        self.others: list[Declaration] = []
        self.inner: dict[int, tuple[ModelDeclaration | Package, _Body]] = {}  # by position among the others
        self.scenes: dict[str, list[tuple[int, Scene]]] = {}  # with the number of others before it
        for d in declarations:
            if isinstance(d, Scene):
                self.scenes.setdefault(d.name, []).append((len(self.others), d))
                continue
            if isinstance(d, ModelDeclaration | Package):
                self.inner[len(self.others)] = d, _Body(d.body)
            self.others.append(d)

    def only(self, name: str) -> tuple[Declaration, ...]:
        kept = list(self.others)
        for k, (d, body) in self.inner.items():
            kept[k] = replace(d, body=body.only(name))
        for before, scene in reversed(self.scenes.get(name, [])):
            kept.insert(before, scene)
        return tuple(kept)

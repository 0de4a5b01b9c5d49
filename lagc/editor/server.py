"""The language server: the answers of `Document` over the Language Server Protocol.

A key costs one parse, after PAUSE, and names and dimensions if they are found quickly.  The whole check runs
in another process after REST without a key; it is ended when the text changes.
"""

import asyncio
import json
import os
import sys
from collections.abc import Iterable
from typing import Any, TypeAlias

from lsprotocol import types as lsp
from pygls.exceptions import JsonRpcInvalidParams
from pygls.lsp.server import LanguageServer
from pygls.uris import from_fs_path, to_fs_path

from lagc.diagnostics.catalogue import entries
from lagc.diagnostics.faults import Edit, Refused, Source, Span, as_json
from lagc.editor.completion import Offer
from lagc.editor.document import Document
from lagc.editor.fixes import fix
from lagc.editor.names import Declared, Names
from lagc.host.model_library import messages_folder
from lagc.version import __version__

PAUSE, REST = 0.03, 0.3  # s without a key before a parse, before the whole check
LARGEST = 1 << 26  # bytes of an answer of the worker
COMPLETIONS = {
    "keyword": lsp.CompletionItemKind.Keyword, "type": lsp.CompletionItemKind.Class,
    "unit": lsp.CompletionItemKind.Unit, "function": lsp.CompletionItemKind.Function,
    "thing": lsp.CompletionItemKind.Constructor, "model": lsp.CompletionItemKind.Module,
    "argument": lsp.CompletionItemKind.Property, "member": lsp.CompletionItemKind.Field,
    "constant": lsp.CompletionItemKind.Constant, "effect": lsp.CompletionItemKind.Event,
}  # fmt: skip
SYMBOLS = {
    "model": lsp.SymbolKind.Class, "package": lsp.SymbolKind.Package, "effect": lsp.SymbolKind.Namespace,
    "scene": lsp.SymbolKind.Event, "function": lsp.SymbolKind.Function, "parameter": lsp.SymbolKind.Constant,
    "constant": lsp.SymbolKind.Constant, "type": lsp.SymbolKind.TypeParameter, "body": lsp.SymbolKind.Object,
    "instance": lsp.SymbolKind.Object,
}  # fmt: skip
Asked: TypeAlias = (
    lsp.HoverParams | lsp.DefinitionParams | lsp.ReferenceParams | lsp.RenameParams | lsp.CompletionParams
)


class Worker:
    """The process of `worker`; jobs wait for one another."""

    def __init__(self) -> None:
        self.process: asyncio.subprocess.Process | None = None
        self.lock = asyncio.Lock()
        self.name = ""  # of the document at which it works

    async def ready(self) -> asyncio.subprocess.Process:
        """Return the process, started if there is none."""
        if self.process is None or self.process.returncode is not None:
            command = (sys.executable, "-m", "lagc.editor.worker")
            self.process = await asyncio.create_subprocess_exec(*command, stdin=-1, stdout=-1, limit=LARGEST)
        return self.process

    def drop(self, name: str) -> None:
        """End the job that runs on a document."""
        if self.name == name and self.process is not None:
            self.process.kill()
            self.process = None

    async def ask(self, do: str, document: Document, **more: object) -> dict[str, Any]:
        """Return the answer to a job; empty if it was ended."""
        job = {"do": do, "name": document.source.name, "text": document.source.text, "roots": document.roots}
        async with self.lock:
            process = await self.ready()
            assert process.stdin is not None and process.stdout is not None
            self.name = document.source.name
            process.stdin.write(json.dumps({**job, **more}).encode() + b"\n")
            try:
                line = await process.stdout.readline()
            finally:
                self.name = ""
        return dict(json.loads(line)) if line else {}


class Server(LanguageServer):
    def __init__(self) -> None:
        super().__init__("lagc", __version__, text_document_sync_kind=lsp.TextDocumentSyncKind.Full)
        self.documents: dict[str, Document] = {}
        self.looks: dict[str, asyncio.Task[None]] = {}
        self.worker = Worker()

    def document(self, uri: str) -> Document:
        """Return the document of a text that is open."""
        text, found = self.workspace.get_text_document(uri).source, self.documents.get(uri)
        if found is None or found.source.text != text:
            path = to_fs_path(uri) or uri
            found = Document(path, text, (os.path.dirname(path),) if os.path.isabs(path) else ())
            self.documents[uri] = found
        return found

    def place(self, params: Asked) -> tuple[Document, int]:
        """Return the document and the offset of a question."""
        document = self.document(params.text_document.uri)
        return document, self.offset(document.source, params.position)

    # -- places: of the protocol in lines and units of UTF-16, or others that the client prefers ----------

    def position(self, source: Source, offset: int) -> lsp.Position:
        line, _ = source.place(offset)
        before = source.text[source.line_starts[line - 1] : offset]
        return lsp.Position(line - 1, self.workspace.position_codec.client_num_units(before))

    def range(self, source: Source, start: int, end: int) -> lsp.Range:
        return lsp.Range(self.position(source, start), self.position(source, end))

    def offset(self, source: Source, position: lsp.Position) -> int:
        if position.line >= len(source.line_starts):
            return len(source.text)
        at, units = source.line_starts[position.line], 0
        while units < position.character and source.text[at : at + 1] not in ("", "\n"):
            units += self.workspace.position_codec.client_num_units(source.text[at])
            at += 1
        return at

    def location(self, span: Span) -> lsp.Location:
        uri = from_fs_path(os.path.abspath(span.source.name)) or ""
        return lsp.Location(uri, self.range(span.source, span.start, span.end))

    def edits(self, document: Document, edits: Iterable[Edit]) -> list[lsp.TextEdit]:
        return [lsp.TextEdit(self.range(document.source, e.start, e.end), e.text) for e in edits]

    # -- faults ------------------------------------------------------------------------

    def diagnostic(self, source: Source, fault: dict[str, Any]) -> lsp.Diagnostic:
        """Return the diagnostic of a fault as plain data; one of another file stands at the beginning."""

        def range_of(place: dict[str, Any]) -> lsp.Range:
            own = place.get("file") == source.name
            first = source.line_starts[place["line"] - 1] + place["column"] - 1 if own else 0
            last = source.line_starts[place["end_line"] - 1] + place["end_column"] - 1 if own else 0
            return self.range(source, first, last)

        uri = from_fs_path(source.name) or source.name
        related = [
            lsp.DiagnosticRelatedInformation(lsp.Location(uri, range_of(place)), place["label"])
            for place in fault["related"]
            if place["file"] == source.name
        ]
        error = fault["severity"] == "error"
        elsewhere = f"{fault['file']}: " if fault["file"] not in (None, source.name) else ""
        return lsp.Diagnostic(
            range_of(fault),
            elsewhere + fault["message"] + (f"\nhelp: {fault['remedy']}" if fault["remedy"] else ""),
            lsp.DiagnosticSeverity.Error if error else lsp.DiagnosticSeverity.Warning,
            code=fault["code"],
            source="lagc",
            related_information=related,
        )

    def publish(self, uri: str, document: Document, faults: list[dict[str, Any]]) -> None:
        found = [self.diagnostic(document.source, fault) for fault in faults]
        version = self.workspace.get_text_document(uri).version
        self.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, found, version))

    async def look(self, uri: str, pause: float) -> None:
        """Publish the faults that are found quickly, then all."""
        await asyncio.sleep(pause)
        document = self.document(uri)
        if document.settled:  # else the faults of before stay
            self.publish(uri, document, as_json(document.faults))
        if document.syntax_faults:
            return
        await asyncio.sleep(REST)
        found = await self.worker.ask("check", document)
        if found and self.documents.get(uri) is document:
            self.publish(uri, document, found["faults"])

    def changed(self, uri: str, pause: float) -> None:
        self.closed(uri)
        self.looks[uri] = asyncio.get_running_loop().create_task(self.look(uri, pause))

    def closed(self, uri: str) -> None:
        """End the work on the text before a change."""
        if uri in self.documents:
            self.worker.drop(self.documents[uri].source.name)
        if uri in self.looks:
            self.looks.pop(uri).cancel()


server = Server()


@server.feature(lsp.INITIALIZED)
async def begin(ls: Server, params: lsp.InitializedParams) -> None:
    async with ls.worker.lock:
        await ls.worker.ready()


@server.feature(lsp.TEXT_DOCUMENT_DID_OPEN)
async def opened(ls: Server, params: lsp.DidOpenTextDocumentParams) -> None:
    ls.changed(params.text_document.uri, 0.0)


@server.feature(lsp.TEXT_DOCUMENT_DID_CHANGE)
async def edited(ls: Server, params: lsp.DidChangeTextDocumentParams) -> None:
    ls.changed(params.text_document.uri, PAUSE)


@server.feature(lsp.TEXT_DOCUMENT_DID_CLOSE)
def closed(ls: Server, params: lsp.DidCloseTextDocumentParams) -> None:
    uri = params.text_document.uri
    ls.closed(uri)
    ls.documents.pop(uri, None)
    ls.text_document_publish_diagnostics(lsp.PublishDiagnosticsParams(uri, []))


@server.feature(lsp.TEXT_DOCUMENT_HOVER)
def hover(ls: Server, params: lsp.HoverParams) -> lsp.Hover | None:
    document, offset = ls.place(params)
    found = document.hover(offset)
    if found is None:
        return None
    text = lsp.MarkupContent(lsp.MarkupKind.Markdown, found.text)
    return lsp.Hover(text, ls.range(document.source, found.start, found.end))


@server.feature(lsp.TEXT_DOCUMENT_DEFINITION)
def definition(ls: Server, params: lsp.DefinitionParams) -> lsp.Location | None:
    document, offset = ls.place(params)
    use = document.names.at(offset)
    return None if use is None else ls.location(use.target.place)


@server.feature(lsp.TEXT_DOCUMENT_REFERENCES)
def references(ls: Server, params: lsp.ReferenceParams) -> list[lsp.Location]:
    document, offset = ls.place(params)
    use = document.names.at(offset)
    return [] if use is None else [ls.location(span) for span in document.names.references(use.target)]


@server.feature(lsp.TEXT_DOCUMENT_RENAME)
def rename(ls: Server, params: lsp.RenameParams) -> lsp.WorkspaceEdit | None:
    document, offset = ls.place(params)
    use = document.names.at(offset)
    if use is None:
        return None
    try:
        edits = document.renamed(use, params.new_name)
    except Refused as refused:
        raise JsonRpcInvalidParams(
            f"`{params.new_name}` cannot be used: {refused.faults[0].message}"
        ) from None
    return lsp.WorkspaceEdit({params.text_document.uri: ls.edits(document, edits)})


@server.feature(lsp.TEXT_DOCUMENT_COMPLETION, lsp.CompletionOptions(trigger_characters=[".", "[", "("]))
def complete(ls: Server, params: lsp.CompletionParams) -> list[lsp.CompletionItem]:
    document, offset = ls.place(params)

    def item(number: int, offer: Offer) -> lsp.CompletionItem:
        kind = COMPLETIONS.get(offer.kind, lsp.CompletionItemKind.Variable)
        detail = offer.detail or offer.kind
        return lsp.CompletionItem(offer.label, kind=kind, detail=detail, sort_text=f"{number:04}")

    return [item(number, offer) for number, offer in enumerate(document.completions(offset))]


@server.feature(lsp.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
def symbols(ls: Server, params: lsp.DocumentSymbolParams) -> list[lsp.DocumentSymbol]:
    document = ls.document(params.text_document.uri)

    def symbol(declared: Declared) -> lsp.DocumentSymbol:
        whole = ls.range(document.source, declared.span.start, declared.span.end)
        name = ls.range(document.source, declared.place.start, declared.place.end)
        kind, detail = SYMBOLS.get(declared.kind, lsp.SymbolKind.Variable), f"{declared.kind} {declared.type}"
        inside = symbols_of(declared.inside) if declared.inside is not None else []
        return lsp.DocumentSymbol(declared.name, kind, whole, name, detail.strip(), children=inside)

    def symbols_of(names: Names) -> list[lsp.DocumentSymbol]:
        return [symbol(declared) for declared in names.own.values()]

    return symbols_of(document.names.top)


@server.feature(lsp.TEXT_DOCUMENT_FORMATTING)
def layout(ls: Server, params: lsp.DocumentFormattingParams) -> list[lsp.TextEdit] | None:
    document = ls.document(params.text_document.uri)
    text = document.formatted()
    if text is None or text == document.source.text:
        return None
    return ls.edits(document, [Edit(0, len(document.source.text), text)])


@server.feature(lsp.TEXT_DOCUMENT_CODE_ACTION, lsp.CodeActionOptions([lsp.CodeActionKind.QuickFix]))
def quick_fixes(ls: Server, params: lsp.CodeActionParams) -> list[lsp.CodeAction]:
    uri = params.text_document.uri
    document, actions = ls.document(uri), list[lsp.CodeAction]()
    for diagnostic in params.context.diagnostics:
        said = diagnostic.code, diagnostic.message.partition("\nhelp: ")[0]
        faults = [fault for fault in document.faults if (fault.code, fault.message) == said]
        found = fix(document, faults[0]) if faults else None
        if found is not None:
            edit = lsp.WorkspaceEdit({uri: ls.edits(document, found.edits)})
            kind = lsp.CodeActionKind.QuickFix
            actions.append(lsp.CodeAction(found.title, kind, [diagnostic], is_preferred=True, edit=edit))
    return actions


@server.command("lagc.equations")
async def equations(ls: Server, uri: str, *chosen: str | None) -> dict[str, Any]:
    """Return the `equations` of motion or the `faults`; `chosen` are model, scene and format."""
    model, scene, format = (*chosen, None, None, None)[:3]
    choice = {"model": model, "scene": scene, "format": format or "text"}
    return await ls.worker.ask("equations", ls.document(uri), **choice)


@server.command("lagc.explain")
def explain(ls: Server, code: str) -> str:
    """Return what a code means, with a wrong and a right example."""
    entry = entries(messages_folder()).get(code)
    return "" if entry is None else entry.shown(code)

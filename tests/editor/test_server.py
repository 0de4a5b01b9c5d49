"""`lagc lsp` and a client, over pipes."""

import asyncio
import sys
from collections.abc import Awaitable, Callable
from pathlib import Path
from typing import Any

import pytest

from tests.editor.texts import PENDULUM

lsp = pytest.importorskip("lsprotocol.types")
clients = pytest.importorskip("pygls.lsp.client")
pytestmark = pytest.mark.full
WAIT = 60.0  # s


class Editor:
    """An editor with one file open."""

    def __init__(self, client: Any, path: Path, text: str):
        self.client, self.uri, self.version, self.text = client, path.as_uri(), 1, text
        self.id = lsp.TextDocumentIdentifier(self.uri)
        self.published: list[Any] = []

        @client.feature(lsp.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)  # type: ignore[untyped-decorator]
        def published(params: Any) -> None:
            self.published.append(params)

    def open(self) -> None:
        item = lsp.TextDocumentItem(self.uri, "lag", self.version, self.text)
        self.client.text_document_did_open(lsp.DidOpenTextDocumentParams(item))

    def type(self, text: str) -> None:
        self.version, self.text = self.version + 1, text
        name = lsp.VersionedTextDocumentIdentifier(version=self.version, uri=self.uri)
        change = [lsp.TextDocumentContentChangeWholeDocument(text)]
        self.client.text_document_did_change(lsp.DidChangeTextDocumentParams(name, change))

    async def faults(self, times: int = 1) -> list[Any]:
        """The faults of this version, published for the first time, or the second: all of them."""
        for _ in range(int(WAIT / 0.01)):
            found = [p.diagnostics for p in self.published if p.version == self.version]
            if len(found) >= times:
                return list(found[times - 1])
            await asyncio.sleep(0.01)
        raise TimeoutError

    def at(self, place: str, shift: int = 0) -> Any:
        before = self.text[: self.text.index(place) + shift]
        column = len(before.rpartition("\n")[2].encode("utf-16-le")) // 2
        return lsp.Position(before.count("\n"), column)

    async def fixes(self, diagnostic: Any) -> list[Any]:
        context = lsp.CodeActionContext([diagnostic])
        params = lsp.CodeActionParams(self.id, diagnostic.range, context)
        return list(await self.client.text_document_code_action_async(params) or ())

    async def run(self, command: str, *arguments: object) -> Any:
        params = lsp.ExecuteCommandParams(command, list(arguments))
        return await self.client.workspace_execute_command_async(params)


def session(path: Path, text: str, talk: Callable[[Editor], Awaitable[None]]) -> None:
    async def whole() -> None:
        client = clients.LanguageClient("test", "1")
        editor = Editor(client, path, text)
        await client.start_io(sys.executable, "-m", "lagc", "lsp", "--stdio")
        await client.initialize_async(lsp.InitializeParams(capabilities=lsp.ClientCapabilities()))
        client.initialized(lsp.InitializedParams())
        editor.open()
        try:
            await talk(editor)
        finally:
            await client.shutdown_async(None)
            client.exit(None)
            await client.stop()

    asyncio.run(asyncio.wait_for(whole(), 3 * WAIT))


def test_faults_and_fixes(tmp_path: Path) -> None:
    async def talk(editor: Editor) -> None:
        assert not await editor.faults(2)
        editor.type(PENDULUM.replace("sin(theta)", "sin(thet)"))
        (found,) = await editor.faults()
        assert found.code == "LAG0201" and "help: did you mean `theta`?" in found.message
        assert found.range.start == editor.at("thet)") and found.severity == lsp.DiagnosticSeverity.Error
        (action,) = await editor.fixes(found)
        (edit,) = action.edit.changes[editor.uri]
        assert action.title == "write `theta`" and edit.new_text == "theta" and edit.range == found.range
        editor.type(PENDULUM.replace("cos(theta)});", "cos(theta)})"))
        (found,) = await editor.faults()
        assert found.code == "LAG0111"

    session(tmp_path / "a.lag", PENDULUM, talk)


def test_later_stages_are_checked_beside_and_end_when_a_key_is_pressed(tmp_path: Path) -> None:
    slow = "model Chain\n  coordinate Angle th[40];\n  point P[0] = {0, 0, 0};\n  for i in 1:40 loop\n"
    slow += "    point P[i] = P[i-1] + 1 [m]*{sin(th[i]), 0, -cos(th[i])};\n"
    slow += "    body b[i] = Particle(mass = 1 [kg], at = P[i]);\n  end for;\nend Chain;\n"

    async def talk(editor: Editor) -> None:
        await editor.faults()
        await asyncio.sleep(0.5)  # the whole check runs
        editor.type(PENDULUM.replace("Length l = 50 [cm]", "Length l"))
        assert not await editor.faults()
        assert [found.code for found in await editor.faults(2)] == ["LAG0603"]
        explained = await editor.run("lagc.explain", "LAG0603")
        assert explained.startswith("LAG0603: ")

    session(tmp_path / "a.lag", slow, talk)


def test_questions(tmp_path: Path) -> None:
    async def talk(editor: Editor) -> None:
        client = editor.client
        hover = await client.text_document_hover_async(lsp.HoverParams(editor.id, editor.at("l*{")))
        assert "string length" in hover.contents.value and "= 0.5 m" in hover.contents.value
        where = lsp.DefinitionParams(editor.id, editor.at("theta), 0"))
        found = await client.text_document_definition_async(where)
        assert found.range.start == editor.at("theta(start") and found.uri == editor.uri
        asked = lsp.ReferenceParams(lsp.ReferenceContext(True), editor.id, editor.at("theta(start"))
        assert len(await client.text_document_references_async(asked)) == 4
        offers = await client.text_document_completion_async(
            lsp.CompletionParams(editor.id, editor.at("at = l*", 5))
        )
        assert {"l", "theta", "sin", "bob"} <= {offer.label for offer in offers}
        renaming = lsp.RenameParams(editor.id, editor.at("theta(start"), "phi")
        edit = await client.text_document_rename_async(renaming)
        assert len(edit.changes[editor.uri]) == 4
        with pytest.raises(Exception, match="cannot be used"):
            await client.text_document_rename_async(
                lsp.RenameParams(editor.id, editor.at("theta(start"), "bob")
            )
        (model,) = await client.text_document_document_symbol_async(lsp.DocumentSymbolParams(editor.id))
        assert " ".join(child.name for child in model.children) == "m l theta bob gravity field E lab"
        editor.type(PENDULUM.replace("  output", "output"))
        options = lsp.FormattingOptions(tab_size=2, insert_spaces=True)
        (layout,) = await client.text_document_formatting_async(
            lsp.DocumentFormattingParams(editor.id, options)
        )
        assert layout.new_text == PENDULUM
        answer = await editor.run("lagc.equations", editor.uri, "Pendulum")
        text = answer["equations"] if isinstance(answer, dict) else answer.equations
        assert "theta''" in text

    session(tmp_path / "a.lag", PENDULUM, talk)

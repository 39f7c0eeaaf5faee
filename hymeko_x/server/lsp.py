"""The server itself: documents that an editor has open, and its questions about them. Speaks the Language Server Protocol."""

from __future__ import annotations

import asyncio
import re
from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.server import LanguageServer

from hymeko_x.server import answers
from hymeko_x.server.analysis import SEVERITIES, Analysis, analyse, analysis, path_of, unpickled, unread
from hymeko_x.server.reader import ReaderProcess, TextReading
from hymeko_x.server.renaming import rename_element
from hymeko_x.server.workspace import Workspace
from hymeko_x.version import __version__

if TYPE_CHECKING:
    from hymeko_x.diagnostics import Diagnostic

_SUGGESTION = re.compile(r"did you mean ([^?]+)\?")


class _Server(LanguageServer):
    """The server with what it knows of the open documents, by their uris."""

    def __init__(self) -> None:
        super().__init__("hymeko-x", __version__)
        self.known: dict[str, Analysis] = {}
        self.reader = ReaderProcess()
        self._waiting: dict[str, asyncio.Future[None]] = {}
        self._thread = ThreadPoolExecutor(1, "reader")

    def document(self, uri: str) -> Analysis:
        """A document in its latest version, with the robot of the last version that was read."""
        text = self.workspace.get_text_document(uri).source
        known = self.known.get(uri)
        if known is None:
            self.known[uri] = analyse(uri, text)
        elif known.text != text:
            self.known[uri] = unread(text, known)
        return self.known[uri]

    def text(self, uri: str) -> Analysis | None:
        """A document of HyMeKo text in its latest version; None for one of another format."""
        document = self.document(uri)
        return document if document.is_text else None

    def around(self) -> Workspace:
        """The open texts, each in its latest version, and those on the disk."""
        return Workspace({uri: self.document(uri) for uri in [*self.workspace.text_documents]})

    def forget(self, uri: str) -> None:
        """Read a document no more that waits to be read."""
        if uri in self._waiting:
            self._waiting.pop(uri).cancel()

    def show(self, uri: str) -> None:
        """Read a document, and send its diagnostics. Meanwhile questions are answered; of waiting versions only the last is read."""
        self.forget(uri)
        if uri not in self.workspace.text_documents:
            return
        text = self.workspace.get_text_document(uri).source
        loop = asyncio.get_running_loop()
        self._waiting[uri] = reading = loop.run_in_executor(self._thread, self._read, loop, uri, text)
        reading.add_done_callback(lambda done: done.cancelled() or done.result())

    def _read(self, loop: asyncio.AbstractEventLoop, uri: str, text: str) -> None:
        """Have a text read; its diagnostics are sent before its robot is there."""
        found: list[Analysis] = []

        def show(reading: TextReading) -> None:
            found.append(analysis(uri, text, reading, self.known.get(uri)))
            loop.call_soon_threadsafe(self._show, uri, found[0])

        robot = self.reader.read(path_of(uri), text, show)
        if robot:
            found[0].last_robot = unpickled(robot)

    def _show(self, uri: str, document: Analysis) -> None:
        """Send the diagnostics of a document that has been read, unless it has been changed since."""
        if uri not in self.workspace.text_documents:
            return
        self.known[uri] = document
        if self.workspace.get_text_document(uri).source == document.text:
            found = [_diagnostic(document, one) for one in document.diagnostics]
            self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, found))


def _diagnostic(document: Analysis, one: Diagnostic) -> types.Diagnostic:
    """A diagnostic at its place; one of another file, which this one imports, stands at the beginning and names it."""
    origin = one.origin
    is_here = origin is None or path_of(origin.file) == document.path
    place = _place(document, one) if is_here else document.places.of_line(1, None)
    message = one.message if is_here else f"{origin}: {one.message}"
    if one.hint:
        message += f"\n{one.hint}"
    severity = types.DiagnosticSeverity(SEVERITIES[one.severity])
    return types.Diagnostic(place, message, severity=severity, code=one.code.id, source="hymeko-x", data=one.hint or None)


def _place(document: Analysis, one: Diagnostic) -> types.Range:
    """The range of a diagnostic: the name that its message quotes, where that stands in its line, else the place that it gives."""
    if one.origin is None:
        return document.places.of_line(1, None)
    place = document.places.of_line(one.origin.line, one.origin.column)
    quoted = re.search(r"'([^']+)'", one.message)
    if quoted is None or one.origin.column is None:
        return place
    start = document.places.offset(place.start)
    line = document.text[start:].partition("\n")[0]
    found = re.search(rf"(?<!\w){re.escape(quoted[1])}(?!\w)", line)
    if found is None:
        return place
    last = start + found.end()
    return document.places.range(last - len(quoted[1].rpartition(".")[2]), last)


def make_server() -> LanguageServer:
    """A server with every feature."""
    server = _Server()

    @server.feature(types.TEXT_DOCUMENT_DID_OPEN)
    def opened(given: types.DidOpenTextDocumentParams) -> None:
        server.show(given.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
    def changed(given: types.DidChangeTextDocumentParams) -> None:
        server.show(given.text_document.uri)

    @server.feature(types.TEXT_DOCUMENT_DID_SAVE)
    def saved(given: types.DidSaveTextDocumentParams) -> None:
        for uri in [*server.workspace.text_documents]:
            server.show(uri)  # a file that others import may have changed

    @server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
    def closed(given: types.DidCloseTextDocumentParams) -> None:
        server.forget(given.text_document.uri)
        server.known.pop(given.text_document.uri, None)
        server.text_document_publish_diagnostics(types.PublishDiagnosticsParams(given.text_document.uri, []))

    @server.feature(types.SHUTDOWN)
    def ending(given: None) -> None:
        server.reader.end()

    _add_answers_at_places(server)
    _add_answers_about_texts(server)
    return server


def _add_answers_at_places(server: _Server) -> None:
    """The features that answer questions about a place in a text; of another format than HyMeKo names can be changed."""

    @server.feature(types.TEXT_DOCUMENT_HOVER)
    def hover(given: types.HoverParams) -> types.Hover | None:
        document = server.text(given.text_document.uri)
        return None if document is None else answers.hover(document, given.position)

    @server.feature(types.TEXT_DOCUMENT_DEFINITION)
    def definition(given: types.DefinitionParams) -> types.Location | None:
        document = server.text(given.text_document.uri)
        return None if document is None else answers.definition(document, given.position, server.around().text)

    @server.feature(types.TEXT_DOCUMENT_REFERENCES)
    def references(given: types.ReferenceParams) -> list[types.Location]:
        document = server.text(given.text_document.uri)
        found = {} if document is None else server.around().references(document, given.position)
        return [types.Location(uri, place) for uri, places in found.items() for place in places]

    @server.feature(types.TEXT_DOCUMENT_RENAME)
    def rename(given: types.RenameParams) -> types.WorkspaceEdit:
        document = server.document(given.text_document.uri)
        change = server.around().rename if document.is_text else rename_element
        edits = change(document, given.position, given.new_name)
        if isinstance(edits, str):
            raise JsonRpcException(message=edits, code=types.LSPErrorCodes.RequestFailed)
        return types.WorkspaceEdit(edits)

    @server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=[".", ":", "+", "-", "~", "=", "@"]))
    def completion(given: types.CompletionParams) -> list[types.CompletionItem]:
        document = server.text(given.text_document.uri)
        return [] if document is None else answers.completion(document, given.position)


def _add_answers_about_texts(server: _Server) -> None:
    """The features that answer questions about a whole HyMeKo text, or a part of it."""

    @server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
    def symbols(given: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
        document = server.text(given.text_document.uri)
        return [] if document is None else answers.symbols(document)

    @server.feature(types.TEXT_DOCUMENT_FOLDING_RANGE)
    def folding(given: types.FoldingRangeParams) -> list[types.FoldingRange]:
        document = server.text(given.text_document.uri)
        return [] if document is None else answers.folding(document)

    @server.feature(types.TEXT_DOCUMENT_FORMATTING)
    def formatting(given: types.DocumentFormattingParams) -> list[types.TextEdit]:
        document = server.text(given.text_document.uri)
        return [] if document is None else answers.formatting(document)

    @server.feature(types.TEXT_DOCUMENT_INLAY_HINT)
    def inlays(given: types.InlayHintParams) -> list[types.InlayHint]:
        document = server.text(given.text_document.uri)
        return [] if document is None else answers.inlays(document, given.range)

    @server.feature(types.TEXT_DOCUMENT_CODE_ACTION)
    def fixes(given: types.CodeActionParams) -> list[types.CodeAction]:
        return [fix for one in given.context.diagnostics for fix in _fixes(given.text_document.uri, one)]


def _fixes(uri: str, one: types.Diagnostic) -> list[types.CodeAction]:
    """The names that a diagnostic suggests, each as an edit."""
    found = _SUGGESTION.search(str(one.message))
    names = [] if found is None else found[1].split(" or ")
    return [
        types.CodeAction(
            f"change to {name}",
            kind=types.CodeActionKind.QuickFix,
            diagnostics=[one],
            edit=types.WorkspaceEdit({uri: [types.TextEdit(one.range, name)]}),
        )
        for name in names
    ]

"""The language server through its protocol, as an editor talks to it."""

from __future__ import annotations

import asyncio
import multiprocessing
import multiprocessing.context
import os
import pickle
import sys
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from msgspec.structs import replace

pytest.importorskip("pygls")

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

from hymeko_x.server import answers
from hymeko_x.server.analysis import Analysis, analyse, unread
from hymeko_x.server.reader import ReaderProcess, TextReading, read
from hymeko_x.server.workspace import Workspace
from tests.pace import assert_at_most
from tests.robot.robots import ARM, URDF_HAND

ROOT = Path(__file__).parents[2]
TEXT = """import "claw.urdf" as claw
arm : robot {
  leg(h) : link { mass ${h} }
  base { mass 2 com [0 0 5cm] inertia [1 1 1] }
  link : leg(h=2) {}
  @elbow : revolute { [0 0 100mm] + base - link axis=Y limit [-90deg 90deg] }
  hand : claw { + link }
  @grip { [0 0 1] + hand.palm - tool }
  tool {}
}
"""


class Editor:
    """An editor with one document open, and the diagnostics that it was sent last."""

    def __init__(self, folder: Path) -> None:
        self.client = LanguageClient("editor", "1")
        self.folder = folder
        self.diagnostics: dict[str, Any] = {}
        self.arrived = asyncio.Event()
        self.version = 0

        @self.client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def told(given: types.PublishDiagnosticsParams) -> None:
            self.diagnostics[given.uri] = given.diagnostics
            self.arrived.set()

    async def open(self, name: str, text: str) -> str:
        uri = (self.folder / name).as_uri()
        self.arrived.clear()
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(types.TextDocumentItem(uri, "hymeko", 0, text)))
        await asyncio.wait_for(self.arrived.wait(), 30)
        return uri

    async def change(self, uri: str, text: str) -> list[types.Diagnostic]:
        self.version += 1
        self.arrived.clear()
        whole = types.TextDocumentContentChangeWholeDocument(text)
        document = types.VersionedTextDocumentIdentifier(uri=uri, version=self.version)
        self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, [whole]))
        await asyncio.wait_for(self.arrived.wait(), 30)
        return list(self.diagnostics[uri])


def edit(folder: Path, work: Callable[[Editor], Awaitable[None]]) -> None:
    """Run an editor's session with a server of its own."""
    (folder / "claw.urdf").write_text(URDF_HAND)

    async def session() -> None:
        editor = Editor(folder)
        await editor.client.start_io(sys.executable, "-m", "hymeko_x", "lsp", env={**os.environ, "PYTHONPATH": str(ROOT)})
        await editor.client.initialize_async(types.InitializeParams(capabilities=types.ClientCapabilities(), root_uri=folder.as_uri()))
        editor.client.initialized(types.InitializedParams())
        await work(editor)
        await editor.client.shutdown_async(None)
        editor.client.exit(None)
        await editor.client.stop()

    asyncio.run(session())


def at(text: str, what: str, nth: int = 0, shift: int = 0) -> types.Position:
    """The position of the n-th occurrence of some words."""
    place = -1
    for _ in range(nth + 1):
        place = text.index(what, place + 1)
    before = text[: place + shift]
    return types.Position(before.count("\n"), len(before) - before.rfind("\n") - 1)


def test_diagnostics_have_codes_places_and_fixes_while_one_types(tmp_path: Path) -> None:
    async def work(editor: Editor) -> None:
        uri = await editor.open("arm.hymeko", TEXT)
        assert [one.message for one in editor.diagnostics[uri] if one.severity == types.DiagnosticSeverity.Error] == []
        broken = TEXT.replace("+ base - link", "+ bsae - link")
        (found,) = await editor.change(uri, broken)
        assert (found.code, found.source, found.severity) == ("HX040", "hymeko-x", types.DiagnosticSeverity.Error)
        assert found.range.start == at(broken, "bsae")
        context = types.CodeActionContext([found])
        actions = await editor.client.text_document_code_action_async(
            types.CodeActionParams(types.TextDocumentIdentifier(uri), found.range, context)
        )
        assert [action.title for action in actions or ()] == ["change to base"]
        (syntax,) = await editor.change(uri, TEXT[:-3])
        assert syntax.code == "HX060"
        assert await editor.change(uri, TEXT) == []

    edit(tmp_path, work)


def test_a_fix_mends_the_text(tmp_path: Path) -> None:
    async def work(editor: Editor) -> None:
        broken = TEXT.replace("+ base - link", "+ bsae - link")
        uri = await editor.open("arm.hymeko", broken)
        (found,) = editor.diagnostics[uri]
        (action,) = await editor.client.text_document_code_action_async(  # type: ignore[misc]
            types.CodeActionParams(types.TextDocumentIdentifier(uri), found.range, types.CodeActionContext([found]))
        )
        assert applied(broken, action.edit.changes[uri]) == TEXT

    edit(tmp_path, work)


def applied(text: str, edits: list[types.TextEdit]) -> str:
    """The text with edits of one line each."""
    lines = text.split("\n")
    for one in sorted(edits, key=lambda one: (-one.range.start.line, -one.range.start.character)):
        line = lines[one.range.start.line]
        lines[one.range.start.line] = line[: one.range.start.character] + one.new_text + line[one.range.end.character :]
    return "\n".join(lines)


def test_names_are_explained_found_and_renamed(tmp_path: Path) -> None:
    async def work(editor: Editor) -> None:
        uri = await editor.open("arm.hymeko", TEXT)
        document, client = types.TextDocumentIdentifier(uri), editor.client

        async def hover(what: str, nth: int = 0, shift: int = 0) -> str:
            found = await client.text_document_hover_async(types.HoverParams(document, at(TEXT, what, nth, shift)))
            return found.contents.value if found is not None and isinstance(found.contents, types.MarkupContent) else ""

        assert await hover("link : leg") == "**body** `link`\n\nmass 2 kg, centre [0 0 0] m\n\nin the world: [0 0 0.1] m, rpy [0 0 0] rad"
        assert (await hover("elbow")).startswith("**joint** `elbow`\n\nhinge, from `base` to `link`\n\nfrom -1.57")
        assert await hover("com [") == "`com`: [x y z], dimension length: the centre of mass in the body"
        assert await hover("limit [") == "`limit`: [lower upper], an angle or a length"
        assert await hover("revolute") == "type `revolute` of a joint"
        assert await hover("palm") == "**body** `hand_palm`\n\nmass 0.5 kg, centre [0 0 0] m\n\nin the world: [0 0 0.1] m, rpy [0 0 0] rad"
        assert await hover("[0 0 5cm]") == ""

        async def defined(what: str, nth: int = 0, shift: int = 0) -> tuple[str, types.Position]:
            found = await client.text_document_definition_async(types.DefinitionParams(document, at(TEXT, what, nth, shift)))
            assert isinstance(found, types.Location)
            return found.uri, found.range.start

        assert await defined("+ base", shift=2) == (uri, at(TEXT, "base {"))
        assert await defined("leg(h=2)") == (uri, at(TEXT, "leg(h)"))
        claw = (tmp_path / "claw.urdf").as_uri()
        assert await defined("palm") == (claw, types.Position(2, 0))
        assert (await defined("claw.urdf"))[0] == claw
        assert (await defined("claw { +"))[0] == claw

        places = await client.text_document_references_async(
            types.ReferenceParams(types.ReferenceContext(True), document, at(TEXT, "link : leg"))
        )
        assert [place.range.start for place in places or ()] == [
            at(TEXT, "link : leg"),
            at(TEXT, "- link", shift=2),
            at(TEXT, "+ link", shift=2),
        ]
        edits = await client.text_document_rename_async(types.RenameParams(document, at(TEXT, "- link", shift=2), "1st"))
        assert edits is not None
        assert edits.changes is not None
        renamed = applied(TEXT, list(edits.changes[uri]))
        assert renamed == TEXT.replace("link : leg", "`1st` : leg").replace("- link", "- `1st`").replace("+ link", "+ `1st`")
        word = await client.text_document_rename_async(types.RenameParams(document, at(TEXT, "- link", shift=2), "use"))
        assert word is not None
        assert word.changes is not None
        assert {one.new_text for one in word.changes[uri]} == {"`use`"}
        with pytest.raises(JsonRpcException, match="there is a 'base' already"):
            await client.text_document_rename_async(types.RenameParams(document, at(TEXT, "tool {}"), "base"))

    edit(tmp_path, work)


LEG = "leg(h) : link { mass ${h} }\nfoot : link { mass 1 }\n"
WALKER = """import "legs.hymeko" as legs
walker : robot {
  base { mass 1 }
  left : leg(h=2) {}
  right : legs.leg(h=3) {}
  @hip : revolute { + base - left axis=Y }
}
"""


def test_references_and_new_names_go_over_imports(tmp_path: Path) -> None:
    (tmp_path / "walker.hymeko").write_text(WALKER)
    (tmp_path / "other.hymeko").write_text("other : robot { leg { mass 1 } }\n")

    async def work(editor: Editor) -> None:
        uri = await editor.open("legs.hymeko", LEG)
        document, client = types.TextDocumentIdentifier(uri), editor.client
        walker = (tmp_path / "walker.hymeko").as_uri()
        expected = [(uri, at(LEG, "leg(")), (walker, at(WALKER, "leg(h=2")), (walker, at(WALKER, "leg(h=3"))]
        context = types.ReferenceContext(True)
        places = await client.text_document_references_async(types.ReferenceParams(context, document, at(LEG, "leg(")))
        assert [(place.uri, place.range.start) for place in places or ()] == expected
        await editor.open("walker.hymeko", WALKER)
        there = types.TextDocumentIdentifier(walker)
        places = await client.text_document_references_async(types.ReferenceParams(context, there, at(WALKER, "leg(h=3")))
        assert [(place.uri, place.range.start) for place in places or ()] == expected
        edits = await client.text_document_rename_async(types.RenameParams(there, at(WALKER, "leg(h=2"), "shank"))
        assert edits is not None
        assert edits.changes is not None
        assert applied(LEG, list(edits.changes[uri])) == LEG.replace("leg(", "shank(")
        assert applied(WALKER, list(edits.changes[walker])) == WALKER.replace("leg(", "shank(")
        with pytest.raises(JsonRpcException, match="there is a 'foot' already"):
            await client.text_document_rename_async(types.RenameParams(there, at(WALKER, "leg(h=2"), "foot"))

    edit(tmp_path, work)


XACRO = """<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">
  <xacro:macro name="leg" params="side">
    <link name="${side}_foot"/>
    <joint name="${side}_ankle" type="fixed"><parent link='base'/><child link="${side}_foot"/></joint>
  </xacro:macro>
  <link name="base"/>
  <link name="left_sole"/>
  <joint name="left_toe" type="fixed"><parent link="left_foot"/><child link="left_sole"/></joint>
  <xacro:leg side="left"/>
</robot>
"""


def test_elements_of_other_formats_get_other_names_wherever_they_stand(tmp_path: Path) -> None:
    async def work(editor: Editor) -> None:
        async def renamed(file: str, text: str, what: str, nth: int, name: str) -> str:
            uri = await editor.open(file, text)
            place = at(text, what, nth, len(what) - 2)
            found = await editor.client.text_document_rename_async(types.RenameParams(types.TextDocumentIdentifier(uri), place, name))
            assert found is not None
            assert found.changes is not None
            return applied(text, list(found.changes[uri]))

        assert await renamed("claw.urdf", URDF_HAND, 'link="palm"', 0, "a<b") == URDF_HAND.replace('"palm"', '"a&lt;b"')
        assert await renamed("arm.xml", ARM, 'joint name="shoulder"', 0, "yaw") == ARM.replace('"shoulder"', '"yaw"')
        expected = XACRO.replace("'base'", "'trunk'").replace('"base"', '"trunk"')
        assert await renamed("r.xacro", XACRO, 'link name="base"', 0, "trunk") == expected
        with pytest.raises(JsonRpcException, match="there is a body 'finger' already"):
            await renamed("claw.urdf", URDF_HAND, 'link name="palm"', 0, "finger")
        with pytest.raises(JsonRpcException, match="there is no name of an element here"):
            await renamed("claw.urdf", URDF_HAND, 'mass value="0.5"', 0, "finger")
        assert await renamed("r.xacro", XACRO, 'parent link="left_foot"', 0, "left_hoof") == XACRO.replace("_foot", "_hoof")
        twice = XACRO.replace("</robot>", '  <xacro:leg side="right"/>\n</robot>')
        with pytest.raises(JsonRpcException, match="'left_foot' stands in the text in more places"):
            await renamed("r.xacro", twice, 'parent link="left_foot"', 0, "left_hoof")

    edit(tmp_path, work)


def test_completion_knows_types_names_fields_units_and_groups(tmp_path: Path) -> None:
    async def work(editor: Editor) -> None:
        uri = await editor.open("arm.hymeko", TEXT)

        async def labels(line: str) -> set[str]:
            text = TEXT.replace("  tool {}", line)
            await editor.change(uri, text)
            place = at(text, line, shift=len(line))
            found = await editor.client.text_document_completion_async(types.CompletionParams(types.TextDocumentIdentifier(uri), place))
            return {item.label for item in found or () if isinstance(item, types.CompletionItem)}

        assert {"revolute", "leg", "claw", "motor"} <= await labels("  tool : ")
        assert {"base", "link", "elbow"} <= await labels("  @j { + ")
        assert {"axis", "limit", "damping", "effort"} <= await labels("  @j { ")
        assert {"mass", "com", "inertia", "visual"} <= await labels("  tool { ")
        assert {"box", "at", "material"} <= await labels("  tool { visual { ")
        assert {"palm", "finger", "close"} <= await labels("  @j { + hand.")
        assert {"mm", "deg", "kg"} <= await labels("  tool { mass 5")

    edit(tmp_path, work)


def test_the_whole_text_has_symbols_folds_layout_and_values_in_si(tmp_path: Path) -> None:
    async def work(editor: Editor) -> None:
        uri = await editor.open("arm.hymeko", TEXT.replace("  tool {}", "tool{}"))
        document, client = types.TextDocumentIdentifier(uri), editor.client
        (root,) = await client.text_document_document_symbol_async(types.DocumentSymbolParams(document)) or ()
        assert isinstance(root, types.DocumentSymbol)
        assert [child.name for child in root.children or ()] == ["leg", "base", "link", "elbow", "hand", "grip", "tool"]
        (fold,) = await client.text_document_folding_range_async(types.FoldingRangeParams(document)) or ()
        assert (fold.start_line, fold.end_line) == (1, 8)
        (edits,) = (
            await client.text_document_formatting_async(types.DocumentFormattingParams(document, types.FormattingOptions(2, True))) or ()
        )
        assert edits.new_text == TEXT
        whole = types.Range(types.Position(0, 0), types.Position(99, 0))
        hints = await client.text_document_inlay_hint_async(types.InlayHintParams(document, whole)) or ()
        assert [hint.label for hint in hints] == ["= 0.05 m", "= 0.1 m", "= -1.5708 rad", "= 1.5708 rad"]

    edit(tmp_path, work)


def test_other_formats_get_the_diagnostics_of_check(tmp_path: Path) -> None:
    async def work(editor: Editor) -> None:
        uri = await editor.open(
            "arm.urdf", '<robot name="r">\n<link name="a"/>\n<joint name="j" type="revolut">\n<parent link="a"/>\n</joint></robot>'
        )
        assert ("HX045", 2) in {(one.code, one.range.start.line) for one in editor.diagnostics[uri]}
        mjcf = await editor.open("arm.xml", ARM.replace('mass="1"', 'mass="0"'))
        assert [one.code for one in editor.diagnostics[mjcf]] == ["HX314"], "what `check` finds"
        document = types.TextDocumentIdentifier(uri)
        assert await editor.client.text_document_hover_async(types.HoverParams(document, types.Position(1, 3))) is None

    edit(tmp_path, work)


def test_questions_are_answered_while_a_long_text_is_read(tmp_path: Path) -> None:
    tower = "\n".join(
        ["tower : robot {", *(f"  body_{number} {{ mass 1 com [0 0 10cm] inertia [1 1 1] }}" for number in range(12_000)), "}"]
    )

    async def session(editor: Editor) -> None:
        long, short = await editor.open("tower.hymeko", tower), types.TextDocumentIdentifier(await editor.open("arm.hymeko", TEXT))
        reading = asyncio.create_task(editor.change(long, tower.replace("mass 1", "mass", 1)))
        await asyncio.sleep(0.2)
        found = await editor.client.text_document_hover_async(types.HoverParams(short, at(TEXT, "link : leg")))
        assert found is not None
        assert not reading.done()
        assert [diagnostic.code for diagnostic in await reading] == ["HX062"]

    edit(tmp_path, session)


@pytest.mark.unread("HX901", "HX060")
def test_a_text_that_ends_the_process_that_reads_is_an_error_and_the_next_one_is_read(tmp_path: Path) -> None:
    reader, path = ReaderProcess(), str(tmp_path / "arm.hymeko")
    shown: list[TextReading] = []
    robot = reader.read(path, "arm : robot { base { mass 1 } }", shown.append)
    assert replace(shown.pop(), robot=pickle.loads(robot)) == read(path, "arm : robot { base { mass 1 } }")
    (process,) = (child for child in multiprocessing.active_children() if isinstance(child, multiprocessing.context.SpawnProcess))
    process.kill()
    assert reader.read(path, "arm : robot {}", shown.append) == b""
    (found,) = shown.pop().diagnostics
    assert str(found) == f"{path}: error[HX901]: the process that read the text ended with exit code -9"
    assert reader.read(path, "arm : robot {", shown.append) == b""
    assert shown == [read(path, "arm : robot {")]
    reader.end()


def test_a_question_after_a_keystroke_in_a_thousand_lines_is_answered_soon() -> None:
    """0.1 s is what an editor's user does not notice. In processor time and against sorting, since machines under load are slower."""
    bodies = [f"  body_{number} {{ mass 1 com [0 0 10cm] inertia [1 1 1] shape {{ box [0.1 0.1 0.1] }} }}" for number in range(500)]
    joints = [f"  @joint_{number} {{ [0 0 0.1] + body_{number} - body_{number + 1} axis=Y limit [-9 9] }}" for number in range(499)]
    text = "\n".join(["r : robot {", *bodies, *joints, "}"])
    known = analyse("long.hymeko", text)
    assert known.diagnostics == []
    questions: dict[str, Callable[[Analysis], object]] = {
        "formatting": answers.formatting,
        "diagnostics": lambda document: analyse("long.hymeko", document.text),
        "completion": lambda document: answers.completion(document, types.Position(700, 24)),
        "hover": lambda document: answers.hover(document, types.Position(400, 4)),
        "references": lambda document: answers.references(document, types.Position(400, 4)),
        "definition": lambda document: answers.definition(document, types.Position(700, 30), lambda path: None),
        "symbols": answers.symbols,
        "folding": answers.folding,
        "inlays": lambda document: answers.inlays(document, types.Range(types.Position(0, 0), types.Position(60, 0))),
        "renaming": lambda document: Workspace({"long.hymeko": document}).rename(document, types.Position(400, 4), "other"),
    }
    for name, ask in questions.items():
        edits = iter(range(10, 20))

        def answered(ask: Callable[[Analysis], object] = ask, edits: Iterator[int] = edits, name: str = name) -> None:
            assert ask(unread(text.replace("mass 1 com", f"mass {next(edits)} com", 1), known)), name

        assert_at_most({"diagnostics": 12.0, "formatting": 7.0}.get(name, 5.0), answered, lambda: sorted(map(str, range(100_000))))

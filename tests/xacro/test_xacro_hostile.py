"""Files from strangers: whatever they try, one diagnostic, and within the limits."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from hymeko_x import codes
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.frontends.xacro.child.limits import ExpansionLimits
from hymeko_x.frontends.xacro.expand import expand
from hymeko_x.source import Source
from tests.xacro.samples import Folder

SMALL = ExpansionLimits(cpu_seconds=1, wall_seconds=20.0, memory_bytes=200 * 2**20)
DOUBLING = "".join(f'<xacro:macro name="m{n}"><xacro:m{n + 1}/><xacro:m{n + 1}/></xacro:macro>' for n in range(40))


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ('<xacro:macro name="a"><xacro:a/></xacro:macro><xacro:a/>', "macros, includes or expressions are nested too deep"),
        ('<xacro:include filename="r.xacro"/>', "macros, includes or expressions are nested too deep"),
        ("<a>" * 2000 + "</a>" * 2000, "macros, includes or expressions are nested too deep"),
        ("${(lambda f: f(f))(lambda f: f(f))}", "macros, includes or expressions are nested too deep"),
        (f'{DOUBLING}<xacro:macro name="m40"/><xacro:m0/>', "it takes more than 1 s of processor time"),
        ("${len([0 for a in python.range(10**9)])}", "it needs more than 200 MiB of memory"),
        ("${list(python.range(10**10))}", "it needs more than 200 MiB of memory"),
        ("${'a' * 10**12}", "it needs more than 200 MiB of memory"),
        ("${python.sum(python.range(10**12))}", "it takes more than 1 s of processor time"),
        ("${len(str(7**(10**8)))}", "it takes more than 1 s of processor time"),
    ],
)
def test_what_never_ends_is_stopped(folder: Folder, body: str, reason: str) -> None:
    start = time.monotonic()
    refusal = folder.refusal(body, SMALL)
    assert refusal.code == codes.EXPANSION_LIMIT
    assert refusal.message in (
        f"the expansion was stopped: {reason}",
        "the expansion was stopped: it takes more than 1 s of processor time",
    )
    assert refusal.origin is not None
    assert refusal.origin.file == str(folder.path / "r.xacro")
    assert time.monotonic() - start < 20.0


def test_a_child_that_does_nothing_is_stopped_by_the_clock(folder: Folder) -> None:
    refusal = folder.refusal("${python.sum(python.range(10**12))}", ExpansionLimits(cpu_seconds=1000, wall_seconds=0.5))
    assert (refusal.code, refusal.message) == (codes.EXPANSION_LIMIT, "the expansion was stopped: it takes more than 0.5 s")


@pytest.mark.parametrize(
    ("expression", "name"),
    [
        ("__import__('os').getcwd()", "__import__"),
        ("().__class__", "__class__"),
        ("(lambda: ().__class__)()", "__class__"),
        ("[x.__class__ for x in [1]]", "__class__"),
        ("'a'.join(x.__doc__ for x in [1])", "__doc__"),
        ("(1 for x in [1]).gi_frame", "gi_frame"),
        ("(lambda g: g.gi_frame)(1)", "gi_frame"),
    ],
)
def test_expressions_do_not_leave_the_fence(folder: Folder, expression: str, name: str) -> None:
    refusal = folder.refusal(f'\n<link name="${{{expression}}}"/>')
    assert refusal.code == codes.FORBIDDEN_EXPRESSION
    assert refusal.message == f"the expression '{expression}' uses '{name}', which expressions may not"
    assert str(refusal.origin) == f"{folder.path}/r.xacro:3"


@pytest.mark.parametrize("function", ["open", "exec", "eval", "getattr", "vars", "globals", "compile", "input", "breakpoint"])
@pytest.mark.parametrize("form", ["${{{}}}", "$(eval ${{p}})", "${{python.{}}}"])
def test_no_dangerous_function_is_within_reach(folder: Folder, form: str, function: str) -> None:
    refusal = folder.refusal(f'<xacro:property name="p" value="{function}"/>\n<link name="{form.format(function)}"/>')
    assert refusal.code == codes.EXPANSION_FAILED
    assert f"name '{function}' is not defined" in refusal.message


def test_eval_runs_no_code_through_a_property(folder: Folder) -> None:
    """xacro's own $(eval ...) would do this, with all of Python's functions."""
    mark = folder.path / "mark"
    refusal = folder.refusal(f'<xacro:property name="p" value="open(\'{mark}\', \'w\').close()"/>\n<link name="$(eval ${{p}})"/>')
    assert refusal.message == "xacro: name 'open' is not defined"
    assert not mark.exists()


def test_a_file_that_is_no_xml_shows_nothing_of_itself(folder: Folder) -> None:
    folder.put("secret.txt", "root:x:0:0:password\n")
    refusal = folder.refusal('<xacro:include filename="secret.txt"/>')
    assert (refusal.code, refusal.message) == (codes.NOT_XML, "not XML: syntax error")
    assert str(refusal.origin) == f"{folder.path}/secret.txt:1"


@pytest.mark.skipif(not Path("/etc/passwd").is_file(), reason="there is no such file here")
def test_the_list_of_users_is_no_robot(folder: Folder) -> None:
    refusal = folder.refusal('<xacro:include filename="/etc/passwd"/>')
    assert (refusal.code, str(refusal.origin)) == (codes.NOT_XML, "/etc/passwd:1")
    assert refusal.message in ("not XML: syntax error", "not XML: not well-formed (invalid token)")


@pytest.mark.parametrize("body", ['<xacro:include filename="/etc/passwd"/>', "<a>${xacro.load_yaml('/etc/passwd')}</a>"])
def test_the_list_of_users_is_out_of_reach_where_reading_is_confined(folder: Folder, body: str) -> None:
    refusal = folder.refusal(body, confine=folder.path)
    assert refusal.message == "the file '/etc/passwd' cannot be read: no such file, or none that may be read"


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b'<!DOCTYPE r [\n<!ENTITY a "b">]><robot/>', "r.xacro:2: error[HX008]: the file defines XML entities, which are never expanded"),
        (b"", "r.xacro:1: error[HX004]: not XML: no element found"),
        (b"\xff\xfe\x00\x01", "r.xacro:1: error[HX004]: not XML: "),
        (b"<robot><xacro:if/></robot>", "r.xacro:1: error[HX004]: not XML: unbound prefix"),
        (b"<a>\n</b>", "r.xacro:2: error[HX004]: not XML: mismatched tag"),
    ],
)
def test_broken_xml_is_refused_with_its_line(data: bytes, message: str) -> None:
    with pytest.raises(Refusal) as refusal:
        expand(Source("r.xacro", data), Report())
    assert str(refusal.value).split("\n")[0].startswith(message)


@pytest.mark.parametrize(
    "body",
    [
        "<xacro:property/>",
        "<xacro:insert_block/>",
        "<xacro:macro/>",
        "<xacro:call/>",
        "<xacro:include/>",
        "<xacro:element/>",
        "<xacro:attribute/>",
        "<xacro:arg/>",
        "<xacro:if/>",
        '<xacro:if value="maybe"/>',
        '<xacro:include filename=""/>',
        '<xacro:include filename="a&#9;b"/>',
        '<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/>${a}',
        '<xacro:call macro="a"/>',
        '<xacro:no.macro.here x="1"/>',
        "${1/0}",
        "${",
        "$(find)",
        "$(nonsense)",
        "$(eval 1 +)",
        "${'}",
        "${xacro.load_yaml('r.xacro').a}",
        "${xacro.fatal('no')}",
        "<xacro:property name='__a' value='1'/>",
        "${max()}",
        "${[][0]}",
        "${{}['a']}",
        "${undefined.attribute}",
        "$(dirname)",
    ],
)
def test_every_mistake_is_one_diagnostic_with_a_line(folder: Folder, body: str) -> None:
    refusal = folder.refusal(body)
    assert refusal.code in (codes.EXPANSION_FAILED, codes.INCLUDE_NOT_FOUND)
    assert refusal.origin is not None
    assert refusal.origin.line in (1, 2)
    assert "Traceback" not in str(refusal)
    assert "\n" not in refusal.message


def test_a_child_that_cannot_start_is_a_diagnostic(folder: Folder, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("sys.executable", str(tmp_path / "no-python"))
    refusal = folder.refusal("<a/>")
    assert refusal.code == codes.EXPANSION_FAILED
    assert refusal.message.startswith("no process can be started for the expansion: ")


def test_a_child_that_ends_without_a_word_is_a_diagnostic(folder: Folder, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.executable", "/bin/false")
    refusal = folder.refusal(f"<!-- {'x' * 2**20} -->")
    assert (refusal.code, refusal.message) == (
        codes.EXPANSION_LIMIT,
        "the expansion was stopped: its process ended with status 1; the limits are 20 s of processor time and 1024 MiB of memory",
    )

"""Diagnostics from the messages of the child: why an expansion failed, and notices about one that succeeded."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from hymeko_x import codes
from hymeko_x.diagnostics import Code, Diagnostic, Origin, Refusal, Severity, refuse
from hymeko_x.extras import install_command

if TYPE_CHECKING:
    from collections.abc import Mapping

    from hymeko_x.frontends.xacro.child.limits import ExpansionLimits

    Message = Mapping[str, object]
    """A message of the child, as JSON gives it."""

LONGEST_TEXT = 600
_KILLED = (-9, -24)
"""How the system ends a process whose time is up: SIGKILL, SIGXCPU."""
_XACRO_NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


def refusal(failed: Message, source: str, limits: ExpansionLimits) -> Refusal:
    """The refusal with the reason why the child failed."""
    code, message, hint = _reason(failed, limits)
    return refuse(code, message, _origin(failed, source), hint=hint, excerpt=_calls(failed))


def _reason(failed: Message, limits: ExpansionLimits) -> tuple[Code, str, str]:
    name = str(failed.get("name", ""))
    match failed["kind"]:
        case "argument":
            return codes.ARGUMENT_MISSING, f"the argument '{name}' is needed here and has no value", _argument_hint(failed)
        case "package":
            return codes.PACKAGE_NOT_FOUND, f"the package '{name}' was not found", _package_hint(name)
        case "file":
            message = f"the file '{failed['path']}' cannot be read: {failed['reason']}"
            return codes.INCLUDE_NOT_FOUND, message, "relative names start from the file that names them"
        case "variable":
            message = f"the environment variable '{name}' is needed here, and the environment is closed to files"
            return codes.ENVIRONMENT_CLOSED, message, f"pass it on with --env {name}, or give it a value with --env {name}=VALUE"
        case "forbidden":
            message = f"the expression '{_short(failed['text'])}' uses '{name}', which expressions may not"
            return codes.FORBIDDEN_EXPRESSION, message, ""
        case "xml":
            return codes.NOT_XML, f"not XML: {failed['text']}", _xml_hint(str(failed["text"]))
        case "entities":
            return codes.ENTITIES, "the file defines XML entities, which are never expanded", ""
        case "limit":
            return codes.EXPANSION_LIMIT, *_limit(str(failed["what"]), limits)
        case "import":
            return codes.LIBRARY_MISSING, f"the xacro library cannot be loaded: {_short(failed['text'])}", install_command("xacro")
        case _:
            return codes.EXPANSION_FAILED, f"xacro: {_short(failed['text'])}", ""


def _argument_hint(failed: Message) -> str:
    name = failed["name"]
    if "default" not in failed:
        return f"give it one: --arg {name}:=VALUE"
    late = f"the file gives it the default '{_short(failed['default'])}' in line {failed['default_line']}, which xacro evaluates later"
    return f"give it one: --arg {name}:=VALUE ({late})"


def _package_hint(name: str) -> str:
    looked = f"looked for: a package.xml with that name and a folder '{name}' above or beside the file, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH"
    return f"say where it is: --package {name}=DIR ({looked})"


def _xml_hint(text: str) -> str:
    return f"if the prefix is xacro: the root element needs {_XACRO_NAMESPACE}" if "prefix" in text else ""


def _limit(what: str, limits: ExpansionLimits) -> tuple[str, str]:
    reached = {
        "depth": "macros, includes or expressions are nested too deep",
        "memory": f"it needs more than {limits.memory_bytes // 2**20} MiB of memory",
        "time": f"it takes more than {limits.cpu_seconds} s of processor time",
    }
    hint = "look for a macro that calls itself, or a file that includes itself, without an end" if what == "depth" else ""
    return f"the expansion was stopped: {reached[what]}", hint


def ended(status: int, source: str, limits: ExpansionLimits, *, slow: bool) -> Refusal:
    """The refusal for a child that ended without a message, with its exit status; ``slow`` when the clock ran out."""
    if slow:
        problem = f"it takes more than {limits.wall_seconds:g} s"
    elif status in _KILLED:
        problem, _ = _limit("time", limits)
        return refuse(codes.EXPANSION_LIMIT, problem, Origin(source))
    else:
        bounds = f"the limits are {limits.cpu_seconds} s of processor time and {limits.memory_bytes // 2**20} MiB of memory"
        problem = f"its process ended with status {status}; {bounds}"
    return refuse(codes.EXPANSION_LIMIT, f"the expansion was stopped: {problem}", Origin(source))


def notice(facts: Message, source: str) -> Diagnostic:
    """A notice of the child about an expansion that succeeded."""
    origin = _origin(facts, source)
    name = str(facts.get("name", ""))
    match facts["kind"]:
        case "guessed":
            message = f"there is no package '{name}'; the folder '{facts['folder']}' is taken for it"
            return Diagnostic(codes.PACKAGE_NOT_FOUND, Severity.WARNING, message, origin, hint=f"say where it is: --package {name}=DIR")
        case "closed":
            message = f"the environment variable '{name}' is not passed on; its default '{_short(facts['default'])}' is used"
            return Diagnostic(codes.ENVIRONMENT_CLOSED, Severity.NOTE, message, origin, hint=f"pass it on with --env {name}")
        case "unknown":
            known = ", ".join(cast("list[str]", facts["known"])) or "none"
            message = f"the argument '{name}' has no effect: the file does not mention it"
            return Diagnostic(codes.ARGUMENT_UNKNOWN, Severity.WARNING, message, origin, hint=f"arguments of the file: {known}")
        case _:
            return _of_xacro(str(facts["text"]), origin)


def _of_xacro(text: str, origin: Origin) -> Diagnostic:
    """A line that xacro printed, or that the file printed through it."""
    for severity in (Severity.WARNING, Severity.ERROR):
        start = f"{severity.value}: "
        if text.startswith(start):
            return Diagnostic(codes.LIBRARY_MESSAGE, severity, f"xacro: {_short(text.removeprefix(start))}", origin)
    return Diagnostic(codes.LIBRARY_MESSAGE, Severity.NOTE, f"xacro: {_short(text)}", origin)


def _origin(facts: Message, source: str) -> Origin:
    file, line = facts.get("file"), facts.get("line")
    return Origin(str(file), cast("int | None", line)) if file else Origin(source)


def _calls(failed: Message) -> tuple[str, ...]:
    """The calls that led to the failure, from the inside."""
    calls = cast("list[Message]", failed.get("calls", []))
    here = (failed.get("file"), failed.get("line"))
    return tuple(f"  from {call['file']}:{call['line']}: {call['what']}" for call in calls if (call["file"], call["line"]) != here)


def _short(text: object) -> str:
    line = " ".join(str(text).split())
    return f"{line[:LONGEST_TEXT]}..." if len(line) > LONGEST_TEXT else line

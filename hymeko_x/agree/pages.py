"""The result of `agree` for people and for programs: text, JSON, SARIF, JUnit, GitHub's annotations, Markdown."""

from __future__ import annotations

import json
import re
from typing import TYPE_CHECKING
from urllib.parse import quote
from xml.sax.saxutils import escape, quoteattr

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from hymeko_x.agree.robots import Compared, Disagreement

    Json = dict[str, object]

VERSION = 1
_SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/os/schemas/sarif-schema-2.1.0.json"


def text(results: Sequence[Compared]) -> str:
    """A line per robot and per difference, with its places."""
    lines = []
    for result in results:
        count = sum(found.count for found in result.wrong)
        state = "agree" if not count else f"differ: {count} disagreement{'s' if count > 1 else ''}"
        known = sum(found.count for found in result.found) - count
        lines.append(f"{result.robot.name}: {len(result.robot.files)} files {state}" + (f", {known} known" if known else ""))
        lines += [f"  {_places(found)}: {_words(found)}" for found in result.wrong]
        lines += [f"  note: {note}" for note in result.notes]
    return "".join(f"{line}\n" for line in lines)


def _places(found: Disagreement) -> str:
    return " and ".join(map(str, found.places))


def _words(found: Disagreement) -> str:
    """The difference, and how many smaller ones of its quantity it stands for."""
    return f"{found.message} ({found.count - 1} more)" if found.count > 1 else found.message


def as_json(results: Sequence[Compared]) -> str:
    """Every difference, the known ones too; a file like this is a baseline."""
    robots = [
        {
            "name": result.robot.name,
            "files": list(result.robot.files),
            "agrees": not result.wrong,
            "disagreements": [_entry(found) for found in result.found],
            "notes": list(result.notes),
        }
        for result in results
    ]
    return f"{json.dumps({'report': 'hymeko-x agree', 'version': VERSION, 'robots': robots}, indent=2, ensure_ascii=False)}\n"


def _entry(found: Disagreement) -> Json:
    known = found.allowed
    return {
        "files": list(found.files),
        "quantity": found.quantity,
        "element": found.element,
        "message": found.message,
        "places": [{"file": place.file, "line": place.line} for place in found.places],
        "allowed": None if known is None else {"reason": known.reason, "until": known.until.isoformat()},
    }


def baseline_of(text: str) -> set[tuple[str, ...]]:
    """The keys of the differences in a JSON result. Raises: ValueError, KeyError or TypeError where it is none."""
    robots = json.loads(text)["robots"]
    return {(robot["name"], *found["files"], found["quantity"], found["element"]) for robot in robots for found in robot["disagreements"]}


def sarif(results: Sequence[Compared]) -> str:
    """SARIF 2.1.0: a result per difference at its place in the second file, with that in the first as a related one.

    Source: https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html
    """
    found = [one for result in results for one in result.found]
    rules = [{"id": _rule(name), "shortDescription": {"text": name}} for name in dict.fromkeys(one.quantity for one in found)]
    driver = {"name": "hymeko-x agree", "rules": rules}
    run = {"tool": {"driver": driver}, "results": [_sarif_result(one) for one in found]}
    return f"{json.dumps({'$schema': _SCHEMA, 'version': '2.1.0', 'runs': [run]}, indent=2, ensure_ascii=False)}\n"


def _sarif_result(found: Disagreement) -> Json:
    first, second = ({"physicalLocation": _location(place.file, place.line)} for place in found.places)
    result: Json = {
        "ruleId": _rule(found.quantity),
        "level": "error",
        "message": {"text": f"{found.robot}: {found.message}"},
        "locations": [second],
        "relatedLocations": [{"id": 1, **first}],
    }
    if found.allowed is not None:
        result["suppressions"] = [{"kind": "external", "justification": found.allowed.reason}]
    return result


def _location(file: str, line: int | None) -> Json:
    return {"artifactLocation": {"uri": quote(file.replace("\\", "/"))}, "region": {"startLine": line or 1}}


def _rule(quantity: str) -> str:
    return re.sub(r"\W+", "-", quantity)


def junit(results: Sequence[Compared]) -> str:
    """JUnit: a test case for each file that is compared, which fails with its differences; known ones are in its output."""
    cases = [case for result in results for case in _cases(result)]
    failed = sum("<failure" in case for case in cases)
    body = "".join(cases)
    suite = f'<testsuite name="hymeko-x agree" tests="{len(cases)}" failures="{failed}">'
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{suite}\n{body}</testsuite>\n'


def _cases(result: Compared) -> Iterator[str]:
    for file in result.robot.files[1:]:
        here = [found for found in result.found if found.files[1] == file]
        wrong = "".join(f"{_places(found)}: {found.message}\n" for found in here if found.allowed is None)
        known = "".join(f"known ({found.allowed.reason}): {found.message}\n" for found in here if found.allowed is not None)
        count = f"{sum(found.allowed is None for found in here)} differences from {result.robot.files[0]}"
        inside = f"    <failure message={quoteattr(count)}>{escape(wrong)}</failure>\n" if wrong else ""
        inside += f"    <system-out>{escape(known)}</system-out>\n" if known else ""
        yield f"  <testcase classname={quoteattr(result.robot.name)} name={quoteattr(file)}>\n{inside}  </testcase>\n"


def github(results: Sequence[Compared]) -> str:
    """Workflow commands that GitHub shows at the lines of a pull request.

    Source: https://docs.github.com/actions/reference/workflows-and-actions/workflow-commands
    """
    lines = []
    for result in results:
        for found in result.wrong:
            place = found.places[1]
            title = f"{result.robot.name} differs from {found.files[0]}"
            properties = f"file={_property(place.file)},line={place.line or 1},title={_property(title)}"
            lines.append(f"::error {properties}::{_data(f'{found.message} ({_places(found)})')}\n")
        lines += [f"::notice title={_property(result.robot.name)}::{_data(note)}\n" for note in result.notes]
    return "".join(lines)


def _data(words: str) -> str:
    return words.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(words: str) -> str:
    return _data(words).replace(":", "%3A").replace(",", "%2C")


def markdown(results: Sequence[Compared]) -> str:
    """A summary for a job or a pull request."""
    lines = ["| robot | files | |", "| --- | --- | --- |"]
    for result in results:
        answer = f"{sum(found.count for found in result.wrong)} disagreements" if result.wrong else "agree"
        lines.append(f"| {_cell(result.robot.name)} | {_cell(', '.join(result.robot.files))} | {answer} |")
    wrong = [found for result in results for found in result.wrong]
    if wrong:
        lines += ["", "| robot | where | difference |", "| --- | --- | --- |"]
        lines += [f"| {_cell(found.robot)} | {_cell(_places(found))} | {_cell(_words(found))} |" for found in wrong]
    known = [found for result in results for found in result.found if found.allowed is not None]
    if known:
        lines += ["", "| known difference | reason | until |", "| --- | --- | --- |"]
        lines += [f"| {_cell(f.robot)}: {_cell(f.message)} | {_cell(f.allowed.reason)} | {f.allowed.until} |" for f in known if f.allowed]
    return "".join(f"{line}\n" for line in lines)


def tables(results: Sequence[Compared]) -> str:
    """A section for each robot: its files, and how each of them differs from the first one."""
    return "\n".join("\n".join(_section(result)) for result in results)


def _section(result: Compared) -> Iterator[str]:
    first, *others = result.robot.files
    yield f"### {_cell(result.robot.name)}\n\nAgainst `{first}`:\n"
    for file in others:
        found = [found for found in result.wrong if found.files[1] == file]
        yield f"`{file}`\n" if found else f"`{file}`: no difference\n"
        if found:
            yield "| quantity | differences | the largest | lines |\n| --- | --- | --- | --- |"
            for one in found:
                lines = " and ".join(str(place.line or 1) for place in one.places)
                values = one.message.removeprefix(one.quantity).removeprefix(" of ").removeprefix(": ")
                yield f"| {one.quantity} | {one.count} | {_cell(values)} | {lines} |"
            yield ""


def _cell(words: str) -> str:
    return words.replace("|", "\\|").replace("\n", " ")


STYLES: dict[str, Callable[[Sequence[Compared]], str]] = {
    "text": text,
    "json": as_json,
    "sarif": sarif,
    "junit": junit,
    "github": github,
    "markdown": markdown,
}
OF_SUFFIXES = {".json": "json", ".sarif": "sarif", ".xml": "junit", ".md": "markdown", ".txt": "text"}
"""What `--report FILE` writes, by suffix."""

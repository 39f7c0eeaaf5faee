"""One file, in a process of its own: read it once, convert it into every target, and have every result verified.

What is found is appended to a file, one line per step, so that a step that takes the process down costs itself only.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
import time
from collections import Counter
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from msgspec import Struct, field
from msgspec.structs import asdict, replace

from hymeko_x import codes, disk, formats, pipeline
from hymeko_x.corpus.lengths import lengths
from hymeko_x.corpus.plan import CONVERT, ENGINE, READ, forget_peak, peak_megabytes, set_limits
from hymeko_x.corpus.rows import DONE, REFUSED, Cost, Leg, RobotRow
from hymeko_x.diagnostics import Refusal, Report
from hymeko_x.ir.parts import Body, Joint, Shape
from hymeko_x.reporting.aspects import Aspect, aspect_of
from hymeko_x.rewrite import Options

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from hymeko_x.compare.ledger import Loss
    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.plan import Plan
    from hymeko_x.ir.mechanism import Mechanism
    from hymeko_x.source import Source
    from hymeko_x.verify.meshes import Meshes
    from hymeko_x.verify.model import KinematicModel
    from hymeko_x.verify.verdict import Verdict

NOTES = "steps.jsonl"
"""The file in the scratch folder that the steps are written to."""

_PACKAGE = re.compile(rb"(?:package|model)://([^/\"'\s]+)")
_PHYSICAL = (Aspect.PHYSICS, Aspect.SETTINGS)
_INDEX = re.compile(r"\[[^\]]*\]")


class FileWork(Struct):
    """What the steps of one file share: the source as it was read, and the reference reader's model of it."""

    case: Case
    plan: Plan
    folder: Path
    scratch: Path
    source: Source
    mechanism: Mechanism
    model: KinematicModel | None = None
    meshes: Meshes | None = None
    notes: list[str] = field(default_factory=list)


def work(case: Case, plan: Plan, folder: str, scratch: str, steps: Sequence[str]) -> None:
    """Do these steps for a file whose package is at ``folder``; write what comes out to ``scratch``.

    Reading is always done, and noted if it is among the steps. A refusal is a result; any other exception, crash or limit
    ends the process, and the step that has no line is the one that did it.
    """
    set_limits(plan.limits)
    bench = Path(scratch)
    with _measured(case, READ, bench, steps) as found:
        read = _read(case, Path(folder), found)
    if read is None:
        return
    desk = FileWork(case, plan, Path(folder), bench, *read)
    if plan.verify:
        with _measured(case, ENGINE, bench, steps) as found:
            found.update(_ask_engine(desk))
    for step in steps:
        kind, _, target = step.partition(":")
        if target:
            with _measured(case, step, bench, steps) as found:
                leg = _convert(desk, target) if kind == CONVERT else _verify(desk, target)
                found.update(asdict(leg))


@contextmanager
def _measured(case: Case, step: str, scratch: Path, steps: Sequence[str]) -> Iterator[dict[str, Any]]:
    """Note the result of the step, and its cost, once it has come to its end."""
    found: dict[str, Any] = {}
    forget_peak()
    start, processor = time.perf_counter(), time.process_time()
    yield found
    seconds = round(time.perf_counter() - start, 4)
    cost = Cost(case.key, step, seconds, round(time.process_time() - processor, 4), peak_megabytes())
    if step in steps:
        with (scratch / NOTES).open("a", encoding="utf-8") as notes:
            notes.write(json.dumps({"step": step, "found": found, "cost": asdict(cost)}) + "\n")


# ---- the source ------------------------------------------------------------------------------------------------------


def _read(case: Case, folder: Path, found: dict[str, Any]) -> tuple[Source, Mechanism] | None:
    """The source and its mechanism, or None when our reader refuses it. Reading is confined to the folder."""
    report = Report()
    robot = RobotRow(case.key, case.package, case.format)
    try:
        source = disk.open_source(str(folder / case.path), confine=folder)
        source = replace(source, arguments=dict(case.arguments))
        robot = _as_found(robot, source)
        mechanism = pipeline.read(source, formats.by_name(case.format), report)
    except Refusal as refusal:
        found.update(asdict(replace(robot, status=REFUSED, reason=_refusal_text(refusal, folder), diagnostics=_by_code(report, refusal))))
        return None
    found.update(asdict(counted(robot, mechanism, report)))
    return source, mechanism


def _as_found(robot: RobotRow, source: Source) -> RobotRow:
    includes = formats.by_name(robot.format).includes
    return replace(
        robot,
        sha256=hashlib.sha256(source.data).hexdigest(),
        whole=includes is None or not re.search(includes, source.data),
        **asdict(lengths(source.data, robot.format)),
    )


def counted(robot: RobotRow, mechanism: Mechanism, report: Report) -> RobotRow:
    """The row of a file with the numbers of its bodies, joints, dofs and shapes."""
    joints = [joint for _, joint, _ in mechanism.edges(Joint)]
    bodies = len([*mechanism.vertices(Body)])
    shapes = len([*mechanism.edges(Shape)])
    dofs = sum(len(joint.dofs) for joint in joints)
    return replace(robot, bodies=bodies, joints=len(joints), dofs=dofs, shapes=shapes, diagnostics=_by_code(report))


def _ask_engine(desk: FileWork) -> dict[str, str]:
    """The reference reader's model goes to the desk; what it answered is returned."""
    from hymeko_x.verify import model_of
    from hymeko_x.verify.meshes import Meshes

    desk.meshes = Meshes(read=desk.plan.meshes)
    try:
        desk.model = model_of(desk.folder / desk.case.path, arguments=desk.source.arguments)
    except Refusal as refusal:
        return {"engine": REFUSED, "engine_reason": _refusal_text(refusal, desk.folder)}
    return {"engine": DONE, "engine_reason": "", "reader": desk.model.engine}


# ---- the results -----------------------------------------------------------------------------------------------------


def _convert(desk: FileWork, target: str) -> Leg:
    """The source in a target format, written to the scratch folder with its meshes beside it."""
    leg = Leg(desk.case.key, desk.case.format, target)
    report = Report()
    output = _output(desk, target)
    shutil.rmtree(output.parent, ignore_errors=True)
    output.parent.mkdir()
    try:
        place = pipeline.OutputPlace(str(output.parent), "copy")
        result = pipeline.convert(desk.mechanism, formats.by_name(target), Options(keep="beside"), desk.source.files, report, place)
        disk.write_package(result.package, str(output), desk.source.files)
    except Refusal as refusal:
        status = "failed" if refusal.diagnostic.code == codes.BUG else REFUSED
        return replace(leg, status=status, reason=_refusal_text(refusal, desk.folder, desk.scratch), diagnostics=_by_code(report, refusal))
    return replace(
        leg,
        files=len(result.package.files) + len(result.package.copies),
        residue=len(result.package.kept.encode()),
        losses=None if result.losses is None else len(result.losses),
        carried=sum(loss.fate == "kept" for loss in result.losses or ()),
        physical=None if result.losses is None else sum(aspect_of(loss) in _PHYSICAL for loss in result.losses),
        lost=_by_kind(result.losses or ()),
        diagnostics=_by_code(report),
        **asdict(lengths(result.package.main, target)),
    )


def _verify(desk: FileWork, target: str) -> Leg:
    """The verdict about a result, as a leg that holds nothing else. The result is removed."""
    leg = Leg(desk.case.key, desk.case.format, target)
    output = _output(desk, target)
    if not output.parent.exists():
        _convert(desk, target)  # an earlier process did, and died
    if not output.is_file():
        return leg
    if desk.model is None:
        return replace(leg, verdict="not comparable", verdict_reason="the reference reader does not read the source")
    verdict = _verdict(desk, desk.model, output)
    shutil.rmtree(output.parent, ignore_errors=True)
    failed = {check.quantity: check.at for check in verdict.failed}
    unsaid = {gap.quantity: gap.count for gap in verdict.gaps}
    reason = _clean(verdict.reason, desk.folder, desk.scratch)
    return replace(leg, verdict=verdict.verdict, verdict_reason=reason, failed=failed, unsaid=unsaid)


def _verdict(desk: FileWork, model: KinematicModel, output: Path) -> Verdict:
    from hymeko_x.verify import verify

    names = {name.decode("utf-8", "replace") for name in _PACKAGE.findall(output.read_bytes())}
    find = getattr(desk.source.files, "find_package", lambda name: None)
    packages = {name: folder for name in sorted(names) if (folder := find(name))}
    return verify(model, output, samples=desk.plan.samples, meshes=desk.meshes or True, packages=packages)


def _output(desk: FileWork, target: str) -> Path:
    return desk.scratch / target / f"robot{formats.by_name(target).suffixes[0]}"


# ---- words -----------------------------------------------------------------------------------------------------------


def _by_code(report: Report, refusal: Refusal | None = None) -> dict[str, int]:
    ids = [diagnostic.code.id for diagnostic in report] + ([refusal.diagnostic.code.id] if refusal else [])
    return dict(sorted(Counter(ids).items()))


def _by_kind(losses: Sequence[Loss]) -> dict[str, int]:
    """The losses by kind of element, field and end: ``joint dofs.limits.velocity dropped``."""
    kinds = (f"{loss.element.split(' ')[0]} {_INDEX.sub('', loss.field).split(' ')[0]}".rstrip() + f" {_end(loss)}" for loss in losses)
    return dict(sorted(Counter(kinds).items()))


def _end(loss: Loss) -> str:
    """What becomes of it in the words of the format, whatever is carried beside them."""
    if loss.after is None:
        return "dropped"
    return "new" if loss.before is None else "approximated"


def _refusal_text(refusal: Refusal, *folders: Path) -> str:
    return _clean(f"{refusal.diagnostic.code.id}: {refusal.diagnostic.message}", *folders)


def _clean(text: str, *folders: Path) -> str:
    """One line without the places of this machine."""
    for folder in sorted((str(folder) for folder in folders), key=len, reverse=True):
        text = text.replace(folder, "")
    return " ".join(text.split())[:300]

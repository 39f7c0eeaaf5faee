"""Engines that run the files: the processes of this machine, or a Ray cluster. Outcomes come as they are ready, in any order."""

from __future__ import annotations

import hashlib
import socket
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from hymeko_x import codes
from hymeko_x.corpus.rows import tables_of
from hymeko_x.corpus.store import missing, save
from hymeko_x.corpus.supervise import Processes, supervise
from hymeko_x.corpus.work import work
from hymeko_x.diagnostics import refuse
from hymeko_x.extras import install_command

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.plan import Plan
    from hymeko_x.corpus.rows import Outcome, Tables
    from hymeko_x.corpus.store import Store
    from hymeko_x.corpus.supervise import Task

_ERRORS = 40
"""The level of logging.ERROR: Ray speaks of nothing less."""

_AHEAD = 2
"""How many files per worker are handed out before the first of them is done."""


class Engine(Protocol):
    """What runs files."""

    def run(self, cases: Iterable[Case], plan: Plan) -> Iterator[Outcome]:
        """The outcome of every case."""
        ...


class Local:
    """This machine: ``jobs`` files at a time, each in a process of its own. ``cache`` is where remote folders are fetched to."""

    def __init__(self, jobs: int, cache: Path, task: Task = work) -> None:
        self._jobs, self._cache, self._task = jobs, cache, task

    def run(self, cases: Iterable[Case], plan: Plan) -> Iterator[Outcome]:
        """The outcome of every case. A closed iterator ends the processes."""
        processes = Processes()
        threads = ThreadPoolExecutor(self._jobs)
        rest = iter(cases)

        def one(case: Case) -> Outcome:
            return supervise(case, plan, fetched(case.folder, self._cache), processes, self._task)

        running: set[Future[Outcome]] = {threads.submit(one, case) for case in islice(rest, self._jobs * _AHEAD)}
        try:
            while running:
                done, running = wait(running, return_when=FIRST_COMPLETED)
                running |= {threads.submit(one, case) for case in islice(rest, len(done))}
                yield from (future.result() for future in done)
        finally:
            threads.shutdown(wait=False, cancel_futures=True)
            processes.end()
            threads.shutdown()


class OnRay:
    """A Ray cluster that is running: one task per file, which starts a process for it as :class:`Local` does.

    A task whose node dies is run again on another node. Folders must be reachable from every node: shared, or fsspec URLs.
    """

    def __init__(self, address: str | None, cache: Path, task: Task = work) -> None:
        """Raises: Refusal HX301 without Ray, HX001 when the cluster cannot be reached."""
        self._address, self._cache, self._task = address, cache, task

    def run(self, cases: Iterable[Case], plan: Plan) -> Iterator[Outcome]:
        """The outcome of every case, in the order in which they are done."""
        ray = _connected(self._address)
        remote = ray.remote(num_cpus=1, max_retries=-1)(_on_node)
        rest = iter(cases)
        try:
            ahead = _AHEAD * max(1, int(ray.cluster_resources().get("CPU", 1)))
            running = [remote.remote(case, plan, str(self._cache), self._task) for case in islice(rest, ahead)]
            while running:
                done, running = ray.wait(running)
                running += [remote.remote(case, plan, str(self._cache), self._task) for case in islice(rest, len(done))]
                yield from ray.get(done)
        finally:
            ray.shutdown()


def _on_node(case: Case, plan: Plan, cache: str, task: Task) -> Outcome:
    """What a Ray task does."""
    return supervise(case, plan, fetched(case.folder, Path(cache)), Processes(), task)


def _connected(address: str | None) -> Any:
    try:
        import ray
    except ImportError as error:
        raise refuse(codes.ENGINE_MISSING, "ray is not installed", hint=install_command("ray")) from error
    _knock(address)
    try:
        ray.init(address=address or "auto", log_to_driver=False, logging_level=_ERRORS)
    except (ConnectionError, RuntimeError, ValueError) as error:
        words = " ".join(str(error).split())[:200]
        raise refuse(codes.CANNOT_READ, f"no Ray cluster answers at '{address or 'auto'}': {words}", hint="ray start --head") from error
    return ray


def _knock(address: str | None) -> None:
    """Ray ends the process when a cluster does not answer, so its address is tried first.

    Raises: Refusal HX001.
    """
    host, colon, port = (address or "").rpartition(":")
    if not (colon and port.isdigit()) or "/" in host:
        return
    try:
        socket.create_connection((host, int(port)), timeout=5.0).close()
    except OSError as error:
        raise refuse(codes.CANNOT_READ, f"no Ray cluster answers at '{address}': {error}", hint="ray start --head") from error


def fetched(folder: str, cache: Path) -> str:
    """The folder on this machine: itself, or a copy of what an fsspec URL names, fetched once, by the first that needs it.

    Raises: Refusal HX001 when it cannot be fetched.
    """
    if "://" not in folder:
        return folder
    from filelock import FileLock
    from fsspec.core import url_to_fs

    final = cache / "remote" / hashlib.sha256(folder.encode()).hexdigest()[:16]
    final.parent.mkdir(parents=True, exist_ok=True)
    with FileLock(f"{final}.lock"):
        if not final.is_dir():
            part = final.with_suffix(".part")
            files, root = url_to_fs(folder)
            try:
                files.get(root, str(part), recursive=True)
            except OSError as error:
                raise refuse(codes.CANNOT_READ, f"'{folder}' cannot be fetched: {error}") from error
            part.rename(final)
    return str(final)


# ---- a run ----------------------------------------------------------------------------------------------------


def run(
    cases: tuple[Case, ...], plan: Plan, engine: Engine, store: Store, *, resume: bool = False, watch: Callable[[Outcome], None]
) -> Tables:
    """The tables of all cases. ``watch`` is called with every outcome as it comes.

    Whenever the run is stopped, what it had found is kept, and a run with ``resume`` does the rest.

    Raises: Refusal HX002 when the store cannot be used.
    """
    store.open(plan.as_json(), resume=resume)
    for outcome in engine.run(missing(cases, store), plan):
        store.add(outcome)
        watch(outcome)
    tables = tables_of(store.outcomes())
    save(tables, store)
    return tables

"""A batch run: every case that has no result yet is given to an engine, and what comes back is kept at once."""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x.corpus.store import missing
from hymeko_x.corpus.tables import save, tables_of

if TYPE_CHECKING:
    from collections.abc import Callable

    from hymeko_x.corpus.cases import Case
    from hymeko_x.corpus.engines import Engine
    from hymeko_x.corpus.plan import Plan
    from hymeko_x.corpus.rows import Outcome
    from hymeko_x.corpus.store import Store
    from hymeko_x.corpus.tables import Tables


def run(
    cases: tuple[Case, ...], plan: Plan, engine: Engine, store: Store, *, resume: bool = False, watch: Callable[[Outcome], None]
) -> Tables:
    """The tables of all cases. ``watch`` is told of every outcome as it comes.

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

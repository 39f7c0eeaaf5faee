"""`python -m tests.fuzz [FORMAT...] --cases N --seconds S`: damage texts, read them, and tell what should not have happened."""

from __future__ import annotations

import argparse
import sys
import time

from tests.fuzz import ledger
from tests.fuzz.run import FOUND, Task, fuzz
from tests.fuzz.seeds import FORMATS

PROFILES = {"ci": (20_000, 60.0), "nightly": (1_000_000, 3600.0)}
"""How many cases of each format, and for how many seconds at most: minutes for a change, hours for a night."""


def main() -> int:
    """Fuzz each format in turn; 1 when something was found."""
    parser = argparse.ArgumentParser("python -m tests.fuzz", description="Damage texts of every format and read them.")
    parser.add_argument("formats", nargs="*", choices=(*FORMATS, []), metavar="FORMAT", help=f"one or more of: {', '.join(FORMATS)}")
    parser.add_argument("--profile", choices=PROFILES, default="ci", help="how long: minutes (ci) or hours (nightly)")
    parser.add_argument("--cases", type=int, help="how many of each format, whatever the profile says")
    parser.add_argument("--seconds", type=float, help="how long at most for each format, whatever the profile says")
    parser.add_argument("--start", type=int, default=1, help="the number of the first case: the same number is the same text")
    parser.add_argument("--through", default="", metavar="FORMAT", help="write what was read as this format and read it back")
    parser.add_argument("--resume", action="store_true", help="start with the first case that no run has reached yet")
    parser.add_argument("--sums", action="store_true", help="run nothing; tell what was run so far")
    chosen = parser.parse_args()
    if chosen.sums:
        print("\n".join(ledger.sums()))
        return 0
    cases, limit = PROFILES[chosen.profile]
    found = 0
    for format in chosen.formats or FORMATS:
        begin = time.monotonic()
        start = ledger.next_case(format, chosen.through) if chosen.resume else chosen.start
        task = Task(format, chosen.through, start, chosen.cases or cases, chosen.seconds or limit)
        tally = fuzz(task)
        seconds = time.monotonic() - begin
        ledger.note(task, tally, seconds)
        print(f"{format}: {tally.cases} cases from {start} in {seconds:.0f} s, {len(tally.kinds)} kinds of findings", flush=True)
        for kind, number in tally.kinds.items():
            print(f"  {kind}, first in case {number}, kept in {FOUND}", flush=True)
        found += len(tally.kinds)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())

"""`python -m tests.fuzz.guided FORMAT [libFuzzer options]`: texts that reach new lines of a reader are kept and damaged further.

Needs atheris, which has wheels for some versions of Python only; without it there is a message, and nothing is run.
"""

from __future__ import annotations

import sys
from importlib import import_module
from typing import Any

USAGE = "usage: python -m tests.fuzz.guided FORMAT [-runs=N] [-max_total_time=S]"


def main() -> int:
    """Fuzz one format until somebody stops it, or as long as libFuzzer's options say (-runs=N, -max_total_time=S)."""
    if len(sys.argv) < 2:
        print(USAGE, file=sys.stderr)
        return 2
    try:
        import atheris
    except ImportError:
        version = ".".join(map(str, sys.version_info[:2]))
        print(f"atheris is not installed ('pip install atheris'; it has no wheel for every Python, and this is {version}): nothing was run")
        return 0
    with atheris.instrument_imports(include=["hymeko_x"]):
        cases, keeping = import_module("tests.fuzz.cases"), import_module("tests.fuzz.run")
        cases.warm_up(sys.argv[1])
    corpus = keeping.FOUND / f"corpus-{sys.argv[1]}"
    corpus.mkdir(parents=True, exist_ok=True)
    for number, text in enumerate(cases.seeds(sys.argv[1])):
        (corpus / f"seed-{number}").write_bytes(text)
    options = [f"-artifact_prefix={keeping.FOUND}/", "-timeout=10", "-rss_limit_mb=4096", str(corpus)]
    atheris.Setup([sys.argv[0], *sys.argv[2:], *options], _target(sys.argv[1], cases))
    atheris.Fuzz()
    return 0


def _target(format: str, cases: Any) -> Any:
    """What atheris calls with each text; an exception that comes out of it is a finding."""

    def read_one(data: bytes) -> None:
        finding = cases.run(format, data)
        if finding is not None:
            raise AssertionError(f"{finding.where}\n{finding.text}")

    return read_one


if __name__ == "__main__":
    sys.exit(main())

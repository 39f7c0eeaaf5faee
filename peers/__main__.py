"""Make the environments of the peers: `python -m peers [NAME ...]`; one that is there already is left alone."""

from __future__ import annotations

import subprocess
import sys

from peers import PEERS, ROOT


def main(names: list[str]) -> int:
    """Install those that were named, or all. Returns 1 when one could not be."""
    known = {peer.name: peer for peer in PEERS}
    unknown = [name for name in names if name not in known]
    if unknown:
        print(f"no peer is called {unknown[0]}; known: {', '.join(known)}", file=sys.stderr)
        return 2
    failed = []
    for name in names or list(known):
        if known[name].is_installed():
            continue
        print(f"installing {name} into {ROOT / name}")
        try:
            known[name].install()
        except subprocess.CalledProcessError as error:
            failed.append(name)
            print(f"{name} could not be installed: exit {error.returncode}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

"""Reading HyMeKo: our parser against lark with the plain grammar, on the printed texts of all development URDFs.

python -m benchmarks.parse
"""

from __future__ import annotations

import sys
from pathlib import Path

from lark import Lark

import hymeko_x as hx
from benchmarks.robots import robots
from benchmarks.yardstick import best_of, verdict
from hymeko_x.backends.hymeko import document
from hymeko_x.language.parser import parse
from hymeko_x.language.printer import print_document


def main() -> int:
    """Read every text with both, in turns."""
    plain = Lark((Path(__file__).parent / "plain.lark").read_text(encoding="utf-8"), parser="lalr")
    documents = [document(hx.load(path).mechanism) for path in robots("urdf")]
    texts = [print_document(tree) for tree in documents]
    parse("warm { up 1 }")
    total = sum(map(len, texts))
    ours, theirs = best_of(lambda: [parse(text) for text in texts], lambda: [plain.parse(text) for text in texts], 5)
    printing, _ = best_of(lambda: [print_document(tree) for tree in documents], lambda: None, 3)
    print(f"{len(texts)} robots, {total} characters: reading {total / ours / 1e6:.2f} MB/s, printing {total / printing / 1e6:.2f} MB/s")
    return 0 if verdict("reading HyMeKo, lark with the plain grammar / our parser", theirs / ours, 4.0, at_least=True) else 1


if __name__ == "__main__":
    sys.exit(main())

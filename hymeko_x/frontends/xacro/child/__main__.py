"""The one job of the child process: receive it, do it, send the result."""

from __future__ import annotations

import gc
import signal
import sys
from typing import TYPE_CHECKING

from hymeko_x.frontends.xacro.child.channel import Parent
from hymeko_x.frontends.xacro.child.desk import Arguments, Desk, NoticeStream
from hymeko_x.frontends.xacro.child.expander import Expander
from hymeko_x.frontends.xacro.child.failing import failure
from hymeko_x.frontends.xacro.child.limits import lift_memory_limit, set_limits

if TYPE_CHECKING:
    from types import TracebackType


def main() -> None:
    """Do the one job of this process. Whatever goes wrong reaches the parent through `sys.excepthook`."""
    parent = Parent(sys.stdin.buffer, sys.stdout.buffer)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent decides what happens then
    job, data = parent.receive()
    desk = Desk(parent, job["environment"])
    expander: Expander | None = None

    def fail(_: type[BaseException], error: BaseException, trace: TracebackType | None) -> None:
        lift_memory_limit()
        parent.send(failed=failure(error, trace, expander and expander.document))

    sys.excepthook = fail
    gc.disable()  # everything lives until the end
    arguments = Arguments(job["arguments"])
    expander = Expander(desk, arguments)
    sys.stdout = sys.stderr = NoticeStream(desk)
    set_limits(job["cpu_seconds"], job["memory_bytes"])
    lines = expander.expand(job["name"], job["shown"], data)
    for name in sorted(job["arguments"].keys() - arguments.mentioned):
        desk.notice("unknown", None, name=name, known=sorted(arguments.mentioned))
    root = expander.document.documentElement
    parent.send(
        "".join(lines.pieces).encode("utf-8", "replace"),
        done=True,
        places=[(line, *place) for line, place in lines.starts],
        root=root.tagName,
        children=sorted({child.nodeName for child in root.childNodes if child.nodeType == child.ELEMENT_NODE}),
        notices=desk.notices,
    )


if __name__ == "__main__":
    main()

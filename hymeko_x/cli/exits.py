"""The exit codes. Scripts rely on them."""

DONE = 0
FAILED = 1
USAGE = 2
FAIL_ON = 3
DIFFERENT = 4
BUG = 70
INTERRUPTED = 130

TABLE = (
    "exit: 0 done; 1 input could not be read or output not written; 2 usage; 3 --fail-on reached;\n"
    "      4 a difference was found; 70 a bug of ours"
)

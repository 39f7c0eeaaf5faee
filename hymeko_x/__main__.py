"""`python -m hymeko_x` is `hymeko-x`."""

import sys

from hymeko_x.cli import main

if __name__ == "__main__":  # the processes of a batch load it too
    sys.exit(main())

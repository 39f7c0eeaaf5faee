"""`python -m hymeko_x` is `hymeko-x`."""

import sys

from hymeko_x.cli import main

sys.exit(main())

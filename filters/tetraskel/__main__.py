"""`python -m tetraskel` is the command line."""

import sys

from tetraskel.cli import main

sys.exit(main())

"""Makes blind data sets and scores diagnoses of them: the command line of `hidden` (README.md)."""

import sys

from .cli import main

sys.exit(main())

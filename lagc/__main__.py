"""`python -m lagc` is `lagc`."""

import sys

from lagc.cli.main import main

sys.exit(main())

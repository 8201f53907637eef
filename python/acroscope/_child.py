"""Processes of this package: for commands of minutes, and for units that have one of their own.

They load the package from the file that it was loaded from here, so that it need not be found by name: `sys.path` may have been changed, which
no other process knows. Nothing is put into their `sys.path` or environment, which units written in Python have, too.
"""

import sys
from pathlib import Path

_LOADER = """
import importlib.util, sys
spec = importlib.util.spec_from_file_location("acroscope", sys.argv.pop(1))
sys.modules["acroscope"] = module = importlib.util.module_from_spec(spec)
spec.loader.exec_module(module)
from acroscope.__main__ import main
main()
"""

# -P: what lies in the folder that the process is started in is none of its modules.
ARGUMENTS = ["-P", "-c", _LOADER.strip(), str(Path(__file__).resolve().with_name("__init__.py"))]


def command(*words: str) -> list[str]:
    """What starts the command line with these words."""
    return [sys.executable, *ARGUMENTS, *words]

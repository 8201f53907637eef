"""Validates the packed units with FMPy: description against the standard's schema, library, functions.

    python scripts/fmpy_validate.py [FILE.fmu ...]        (default: target/fmus/*.fmu)

Exit status 1 if FMPy has anything to say.
"""

import sys
from pathlib import Path

from fmpy import platform, supported_platforms
from fmpy.validation import validate_fmu

UNITS = Path(__file__).resolve().parent.parent / "target" / "fmus"


def main():
    files = [Path(name) for name in sys.argv[1:]] or sorted(UNITS.glob("*.fmu"))
    if not files:
        sys.exit(f"no units in {UNITS}; build them with `cargo xtask pack`")
    problems = 0
    for file in files:
        found = validate_fmu(str(file))
        problems += len(found)
        here = "runs here" if platform in supported_platforms(str(file)) else f"has no binary for {platform}"
        print(f"{file.name}: {'no problems' if not found else f'{len(found)} problems'}, {here}")
        for problem in found:
            print(f"  {problem}")
    sys.exit(1 if problems else 0)


if __name__ == "__main__":
    main()

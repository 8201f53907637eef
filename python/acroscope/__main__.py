"""The command line: `acroscope ...` and `python -m acroscope ...`."""

import signal
import sys

from . import _acroscope


def main() -> None:
    # Ctrl-C ends the program, as it does with one that is not written in Python.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_acroscope.main(sys.argv[1:]))


if __name__ == "__main__":
    main()

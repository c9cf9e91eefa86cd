"""The program `lugwheel`, as `python -m lugwheel`."""

import sys
from pathlib import Path

from . import _native


def main() -> int:
    """Runs the program with the arguments of this process: its exit code."""
    started_by = Path(sys.argv[0])
    if started_by.name == "__main__.py":
        # The program that pip puts beside the interpreter can be started again; a module cannot.
        started_by = Path(sys.executable).with_name("lugwheel")
    return _native.main(started_by, sys.argv[1:])


if __name__ == "__main__":
    sys.exit(main())

"""The command ``lennard``."""

from __future__ import annotations

import signal
import sys

from . import _lennard


def main() -> None:
    """Runs the command line with the arguments of the process, and exits with its code."""
    # The program answers Ctrl-C itself: it stops after a step, with a checkpoint.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    sys.exit(_lennard.command(["lennard", *sys.argv[1:]]))


if __name__ == "__main__":
    main()

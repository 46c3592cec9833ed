"""``python -m lennard`` is the command ``lennard``."""

from ._cli import main

main()

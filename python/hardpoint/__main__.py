"""Runs the program with `python -m hardpoint`."""

from . import _main

if __name__ == "__main__":
    _main()

"""`python -m hardpoint` is the program."""

from . import _main

if __name__ == "__main__":
    _main()

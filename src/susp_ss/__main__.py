"""``python -m susp_ss``: the command line, where ``susp-ss`` is not on the path."""

from .cli import main

if __name__ == "__main__":
    main()

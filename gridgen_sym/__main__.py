"""Run the command line with `python -m gridgen_sym`."""

from .cli import main

if __name__ == "__main__":
    main()

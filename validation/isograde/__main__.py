"""`python -m isograde` is the command `isograde`."""

from isograde.command import main

if __name__ == "__main__":
    main()

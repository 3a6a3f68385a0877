"""`python -m granular_contact`."""

from granular_contact.cli import main

if __name__ == "__main__":
    raise SystemExit(main())

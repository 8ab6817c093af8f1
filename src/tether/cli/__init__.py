"""The command line: tether run, resume, show, plot, init, schema."""

from __future__ import annotations

import sys

from tether.cli.app import app
from tether.errors import TetherError


def main() -> None:
    """Entry point. Exit codes: 0, 1 for a failed run, 2 for wrong input, 128 + the signal for a stopped run."""
    try:
        app()
    except TetherError as error:
        _say(f"error: {error}")
        sys.exit(error.exit_code)
    except BrokenPipeError:
        sys.exit(141)  # the reader of our output has gone, as after `| head`
    except OSError as error:
        path = f" {error.filename}" if error.filename else ""
        _say(f"error: cannot write or read{path} ({error.strerror or error}); see to the disk, then tether resume")
        sys.exit(1)


def _say(text: str) -> None:
    print(text, file=sys.stderr)

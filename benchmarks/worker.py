"""Another process that is started once and then does one thing for each line that it is sent."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from pathlib import Path

_ANSWER = "answer:"
"""What answers begin with, so that whatever a library prints is not taken for one."""


class Worker:
    """A process `python -m MODULE ARGUMENTS...` that serves (see `serve`)."""

    def __init__(self, module: str, *arguments: str, environment: Mapping[str, str] | None = None) -> None:
        self._process = subprocess.Popen(
            [sys.executable, "-m", module, *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            cwd=Path(__file__).parent.parent,
            env={**os.environ, **(environment or {})},
        )

    def tell(self, line: str) -> None:
        """Send a line without waiting for its answer."""
        assert self._process.stdin is not None
        self._process.stdin.write(f"{line}\n")
        self._process.stdin.flush()

    def answer(self) -> str:
        """The answer to the earliest line that has none yet. Raises RuntimeError when the process has ended."""
        assert self._process.stdout is not None
        for line in self._process.stdout:
            if line.startswith(_ANSWER):
                return line.removeprefix(_ANSWER).strip()
        raise RuntimeError(f"{' '.join(map(str, self._process.args))} ended with status {self._process.wait()}")

    def ask(self, line: str) -> str:
        """Send a line and wait for its answer."""
        self.tell(line)
        return self.answer()

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None
        self._process.stdin.close()
        self._process.wait()


def serve(do: Callable[[str, list[str]], object]) -> None:
    """Answer each line of the standard input: its first word and the others are what `do` is called with."""
    for line in sys.stdin:
        word, *others = line.split()
        print(_ANSWER, do(word, others), flush=True)

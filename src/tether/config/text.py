"""Reading a TOML file, with one sentence for whatever keeps it from being read."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from tether import toml
from tether.config.lines import lines
from tether.errors import InputError, Key

LOOK = "look at the path (`tether init` writes a file to start from)"


def read(path: Path) -> tuple[dict[str, Any], dict[Key, int]]:
    """The values of a TOML file and the line of each key. Raises InputError."""
    text = _text(path)
    try:
        return tomllib.loads(text), lines(text)
    except RecursionError:
        problem = "the lists or tables are nested too deeply"
        raise InputError(problem, "they cannot be read", "write them flat", place=str(path)) from None
    except ValueError as error:
        raise _syntax(path, text, str(error)) from None


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = error.object[: error.start].count(b"\n") + 1
        remedy = "save the file as UTF-8, or look whether it is the right one"
        raise InputError("this is not UTF-8 text", "TOML files are", remedy, place=f"{path}, line {line}") from None
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise InputError(f"{path} cannot be read", reason, LOOK) from None
    except ValueError as error:  # a null character in the path
        raise InputError(f"{toml.value(str(path))} cannot be read", str(error), LOOK) from None


def _syntax(path: Path, text: str, message: str) -> InputError:
    match = re.fullmatch(r"(.*) \(at (?:line (\d+), column (\d+)|end of document)\)", message, re.DOTALL)
    if match is None:  # Python reads integers of up to 4300 digits
        return InputError("a number has thousands of digits", "it cannot be read", "shorten it", place=str(path))
    why = match[1][:1].lower() + match[1][1:]
    # str.splitlines knows more line ends than TOML does.
    number = int(match[2]) if match[2] else len(text.rstrip().split("\n"))
    line = text.split("\n")[number - 1].strip()
    shown = toml.value(line if len(line) <= 60 else f"{line[:56]} ...") if line else "the text"
    return InputError(f"{shown} is not TOML", why, _remedy(line, why), place=f"{path}, line {number}")


def _remedy(line: str, why: str) -> str:
    """What people most often do wrong."""
    if "overwrite" in why or "twice" in why:
        return "give each key and each table once (bodies of several kinds: [[bodies]], with two brackets)"
    if re.search(r"(?<![\d\w])\.\d|\d\.(?!\d)", line):
        return "write a digit on both sides of a decimal point, 0.5 or 5.0"
    if re.search(r"=\s*[A-Za-z]", line):
        return 'put text in quotation marks, for example kind = "couette"'
    return "write [table] or key = value, with text in quotation marks"

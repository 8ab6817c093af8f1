"""`tether report`: one page for runs and studies."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def report(
    folders: Annotated[list[Path], typer.Argument(metavar="DIR...", help="Folders of runs, or of studies.")],
    out: Annotated[Path, typer.Option(help="The page to write.")] = Path("report.html"),
) -> None:
    """Write one HTML page of runs or studies: results, interactive plots, the suspension in 3D; it needs no network."""
    from tether.report.write import report as written  # Plotly and matplotlib take longer to import than the rest

    path = written(folders, out)
    print(f"Wrote {path} ({path.stat().st_size / 1e6:.1f} MB)")

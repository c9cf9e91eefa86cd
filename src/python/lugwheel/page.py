"""Pages of the program in a notebook or a file."""

from __future__ import annotations

import html
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Union

from ._command import document


@dataclass(frozen=True)
class Page:
    """One HTML document that needs nothing else; a notebook shows it."""

    text: str

    def save(self, path: Union[str, os.PathLike]) -> Path:
        """Writes the page to a file, which must not be there yet."""
        path = Path(path)
        with path.open("x", encoding="utf-8") as file:
            file.write(self.text)
        return path

    def _repr_html_(self) -> str:
        style = "width:100%;height:720px;border:0"
        return f'<iframe srcdoc="{html.escape(self.text)}" style="{style}"></iframe>'

    def __repr__(self) -> str:
        return f"<lugwheel page, {len(self.text) / 1e3:.0f} kB>"


def page_of_run(file: Union[str, os.PathLike], id: str) -> Page:
    """The page of a run of a run file."""
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "run.html"
        document(["plot", file, "--run", id, "--out", out])
        return Page(out.read_text(encoding="utf-8"))

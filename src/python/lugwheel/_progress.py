"""Progress of a computation, in a notebook or on stderr."""

from __future__ import annotations

import sys
from typing import Callable, Optional, Union

Listener = Callable[[str, float], None]
"""Called with the name of the stage and the share [0 to 1] of it that is done."""

Progress = Union[bool, Listener]
"""True shows a bar, False nothing; a function is called with stage and share."""


def listener(progress: Progress) -> Optional[Listener]:
    """The listener that `progress` asks for."""
    if callable(progress):
        return progress
    if not progress:
        return None
    return _NotebookBar() if _in_notebook() else _line


def _in_notebook() -> bool:
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython is not None else None
    return shell is not None and shell.__class__.__name__ == "ZMQInteractiveShell"


def _line(stage: str, share: float) -> None:
    filled = int(30 * share)
    end = "\n" if share >= 1.0 else ""
    sys.stderr.write(f"\r{stage} [{'=' * filled}{' ' * (30 - filled)}] {100 * share:3.0f} %{end}")
    sys.stderr.flush()


class _NotebookBar:
    """One line of output that is replaced as the share grows."""

    def __init__(self) -> None:
        from IPython.display import display

        self._handle = display({"text/plain": ""}, raw=True, display_id=True)

    def __call__(self, stage: str, share: float) -> None:
        html = f'<progress value="{share:.3f}"></progress> {stage} {100 * share:.0f} %'
        self._handle.update({"text/html": html, "text/plain": f"{stage} {100 * share:.0f} %"}, raw=True)

"""Commands of the program, run in this process, and their JSON documents."""

from __future__ import annotations

import json
import os
import warnings
from typing import Any, Iterable, List, Optional, Union

from . import _native
from ._progress import Progress, listener

Word = Union[str, os.PathLike, float, int]


def document(words: Iterable[Word], *, progress: Progress = False, partial: bool = False) -> Any:
    """The JSON document of a command; its warnings become Python's.

    With `partial`, a command that failed after it gave its result returns that result.
    """
    arguments = [os.fspath(word) if isinstance(word, os.PathLike) else str(word) for word in words]
    results, told = _native.call([*arguments, "--json", "--quiet"], listener(progress), partial)
    for text in told:
        warnings.warn(text, stacklevel=3)
    return json.loads(results[-1])


def option(name: str, value: Optional[Word]) -> List[Word]:
    """An option of a command, where a value is given."""
    return [] if value is None else [name, value]


def repeated(name: str, values: Optional[Iterable[Word]]) -> List[Word]:
    """An option that may be given several times."""
    if isinstance(values, str):
        values = [values]
    return [word for value in values or () for word in (name, value)]


def flag(name: str, given: bool) -> List[Word]:
    """An option without a value."""
    return [name] if given else []

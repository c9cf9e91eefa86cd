"""Exceptions, with the words of the program."""

from __future__ import annotations

from typing import Optional


class Error(Exception):
    """An error of lugwheel.

    Attributes:
        file: the input file at fault, or None.
        line: the line in it, from 1, or None.
    """

    def __init__(self, message: str, file: Optional[str] = None, line: Optional[int] = None) -> None:
        super().__init__(message)
        self.file = file
        self.line = line


class InvalidInput(Error, ValueError):
    """An argument, a scenario or a file is not what it should be; the message shows the way."""


class Failed(Error, RuntimeError):
    """A computation failed although its input is sound, or a file could not be written."""


class Interrupted(Error):
    """A request from another thread stopped the computation."""


_KINDS = {"usage": InvalidInput, "invalid_input": InvalidInput, "interrupted": Interrupted}


def of_kind(kind: str, message: str, file: Optional[str] = None, line: Optional[int] = None) -> Error:
    """The exception of an error of this `kind`."""
    return _KINDS.get(kind, Failed)(message, file, line)

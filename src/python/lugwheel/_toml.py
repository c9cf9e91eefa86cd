"""Python values as TOML."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Mapping
from typing import Any


def value(of: Any) -> str:
    """A number, text, list or mapping as a TOML value; NumPy's scalars and arrays too."""
    if hasattr(of, "tolist"):
        of = of.tolist()
    if isinstance(of, bool):
        return "true" if of else "false"
    if isinstance(of, int):
        return str(of)
    if isinstance(of, float):
        return repr(of) if math.isfinite(of) else str(of)
    if isinstance(of, (str, os.PathLike)):
        return json.dumps(os.fspath(of))
    if isinstance(of, Mapping):
        return "{ " + ", ".join(f"{key(name)} = {value(item)}" for name, item in of.items()) + " }"
    if isinstance(of, (list, tuple)):
        return "[" + ", ".join(value(item) for item in of) + "]"
    raise TypeError(f"{type(of).__name__} is no number, text, list or mapping")


def key(name: str) -> str:
    """A key, quoted where it has to be."""
    plain = name.replace("_", "").replace("-", "")
    return name if plain.isascii() and plain.isalnum() else json.dumps(name)


def table(items: Mapping[str, Any]) -> str:
    """Lines `key = value`, without those that are None."""
    return "".join(f"{key(name)} = {value(item)}\n" for name, item in items.items() if item is not None)

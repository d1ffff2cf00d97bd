"""What a stage holds and a scene does not: one line for each kind of thing."""

from __future__ import annotations

from typing import Any, Dict, List


class Notes:
    """Collects texts with the prims that they speak of."""

    def __init__(self) -> None:
        self._prims: Dict[str, List[str]] = {}

    def add(self, text: str, path: Any) -> None:
        paths = self._prims.setdefault(text, [])
        if str(path) not in paths[:64]:
            paths.append(str(path))

    def lines(self) -> List[str]:
        result = []
        for text, paths in self._prims.items():
            more = f" and {len(paths) - 1} more" if len(paths) > 1 else ""
            result.append(f"{paths[0]}{more}: {text}" if paths[0] else text)
        return result

"""Errors of the compiled part as Python has them."""

from __future__ import annotations

import errno
import os
import re
from contextlib import contextmanager
from typing import Iterator, Optional, Union

Path = Union[str, "os.PathLike[str]"]


class FileError(OSError):
    """A file that does not hold what it should. `filename` names it, `strerror` says what is wrong.

    A file that is missing, or may not be read or written, raises Python's own FileNotFoundError,
    PermissionError and so on. All of them are OSError.
    """

    def __str__(self) -> str:
        return f"{self.filename}: {self.strerror}"


#: What the system may say about a file.
_SYSTEM_ERRORS = {
    os.strerror(code): code
    for code in (
        errno.ENOENT, errno.EACCES, errno.EPERM, errno.EISDIR, errno.ENOTDIR, errno.EROFS,
        errno.ENOSPC, errno.EDQUOT, errno.ENAMETOOLONG, errno.ELOOP, errno.EIO, errno.EFBIG,
    )
}  # fmt: skip


def _file_error(text: str, path: str) -> OSError:
    reason = text[len(path) + 1 :].lstrip() if text.startswith(f"{path}:") else text
    reason = re.sub(r"^(\d+): ", r"line \1: ", reason)
    for words, code in _SYSTEM_ERRORS.items():
        if words in text:
            return OSError(code, reason, path)
    return FileError(errno.EINVAL, reason, path)


def in_python(text: str) -> str:
    """Names options as Python does: --fix-env is fix_env, --from is convention."""
    text = re.sub(r"^from(?=: )|--from\b", "convention", text)
    return re.sub(r"--([a-z]+(?:-[a-z]+)*)", lambda match: match[1].replace("-", "_"), text)


@contextmanager
def errors(path: Optional[Path] = None, *, only: bool = False) -> Iterator[None]:
    """Turns errors about a file into OSError, and names options as Python does.

    With `only`, errors that do not begin with the path stay what they are.
    """
    try:
        name = None if path is None else os.fspath(path)
    except TypeError:
        raise TypeError(f"path: expected a path, got {type(path).__name__}") from None
    if name == "":
        raise FileNotFoundError(errno.ENOENT, "expected the name of a file, got an empty one", name)
    try:
        yield
    except RuntimeError as error:
        text = in_python(str(error))
        if name and (not only or text.startswith(f"{name}:")):
            raise _file_error(text, name) from None
        raise RuntimeError(text) from None
    except ValueError as error:
        raise ValueError(in_python(str(error))) from None

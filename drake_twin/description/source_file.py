"""The one opener of files that strangers wrote: bytes, text, or XML in any encoding; no device, pipe or huge file."""

import codecs
import os
import re
import stat
from errno import EFBIG, EINVAL, EISDIR
from pathlib import Path
from typing import IO, Any

from drake_twin.errors import InputError

MOST_BYTES = 1 << 30
MOST_TEXT = 1 << 25  # bytes that are parsed, which takes some thirty times their length in memory
_DECLARATION = re.compile(r"""^\s*<\?xml\b[^>]*?(\sencoding\s*=\s*["']([\w.:-]+)["'])[^>]*\?>""")
_PREFIX = re.compile(r"""</?([A-Za-z_][\w.-]*):|\s([A-Za-z_][\w.-]*):[A-Za-z_][\w.-]*\s*=\s*["']""")
_OUTERMOST = re.compile(r"(?:\s|<\?.*?\?>|<!--.*?-->|<!\w[^>]*>)*<[A-Za-z_][\w.-]*(?=[\s/>])", re.DOTALL)
_DEFAULT_NAMESPACE = re.compile(
    r"""(<(?:robot|sdf)\b(?:"[^"]*"|'[^']*'|[^>"'])*?)\sxmlns\s*=\s*(?:"[^"]*"|'[^']*')""", re.DOTALL
)
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (codecs.BOM_UTF8, "utf-8-sig"),
)


def file_bytes(file: str | Path, most: int = MOST_BYTES) -> bytes:
    """Return the content of a file that a stranger may have written: a regular one of reasonable size.

    Args:
        file: The file.
        most: How long it may be (bytes).

    Raises:
        OSError: If it cannot be read, or is something else, such as a pipe, which a reader would wait for.
    """
    descriptor = os.open(file, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))  # or the opening of a pipe would wait
    with open(descriptor, "rb") as stream:
        status = os.fstat(descriptor)
        if stat.S_ISDIR(status.st_mode):
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR), str(file))
        if not stat.S_ISREG(status.st_mode):
            raise OSError(EINVAL, "this is not a file, but a device or a pipe", str(file))
        if status.st_size > most:
            raise OSError(EFBIG, _too_large(status.st_size, most), str(file))
        return stream.read()


def _too_large(size: int, most: int) -> str:
    return f"the file has {size / 1e6:.0f} MB; at most {most >> 20} MB are read"


def file_text(file: str | Path, encoding: str = "utf-8", errors: str = "strict", most: int = MOST_TEXT) -> str:
    """Return the text of a file that a stranger may have written, with the ends of lines of ``open``.

    Args:
        file: The file.
        encoding: Its encoding.
        errors: What becomes of bytes that are not text, as for ``bytes.decode``.
        most: How long it may be (bytes).

    Raises:
        OSError: As `file_bytes`.
        UnicodeDecodeError: If it is not text in its encoding.
    """
    return file_bytes(file, most).decode(encoding, errors).replace("\r\n", "\n").replace("\r", "\n")


def regular_open(file: Any, mode: str = "r", *arguments: Any, **more: Any) -> IO[Any]:
    """Open a file as ``open`` does, but refuse to read anything but a regular one.

    Raises:
        OSError: As `file_bytes`, or as ``open``.
    """
    if "r" in mode and isinstance(file, str | Path):
        try:
            check_regular(Path(file))
        except InputError as error:
            raise OSError(EINVAL, error.message, str(file)) from None
    return open(file, mode, *arguments, **more)


def check_regular(file: Path, most: int | None = MOST_BYTES) -> None:
    """Check that a path is a regular file of reasonable size, and not a device or a pipe.

    Args:
        file: The file.
        most: How long it may be (bytes); None for any length.

    Raises:
        InputError: If it is not a file, or too large.
        OSError: If it does not exist.
    """
    status = file.stat()
    if not stat.S_ISREG(status.st_mode):
        raise InputError("this is not a file, but a folder, a device or a pipe", file=file)
    if most is not None and status.st_size > most:
        raise InputError(_too_large(status.st_size, most), file=file)


def without_default_namespace(text: str) -> str:
    """Remove a namespace that the outermost element gives all others, which urdfdom and libsdformat do not look at."""
    if "xmlns" not in text:
        return text
    return _DEFAULT_NAMESPACE.sub(lambda tag: tag[1] + "\n" * (tag[0].count("\n") - tag[1].count("\n")), text, count=1)


def read_xml(file: Path, what: str) -> str:
    """Read an XML file as text, in the encoding of its byte-order mark or its declaration, which is removed.

    Args:
        file: The file.
        what: Its kind, for the error.

    Raises:
        InputError: If it cannot be read, or is not text in its encoding.
    """
    try:
        data = file_bytes(file, MOST_TEXT)
    except OSError as error:
        raise InputError(f"the {what} cannot be read ({error.strerror})", file=file) from None
    encoding = next((name for mark, name in _MARKS if data.startswith(mark)), None)
    if encoding is None:
        declared = _DECLARATION.match(data[:200].decode("latin-1"))
        encoding = declared[2] if declared else "utf-8"
    try:
        text = data.decode(encoding)
    except (LookupError, UnicodeError):
        raise InputError(f"the {what} is not {encoding.upper().removesuffix('-SIG')} text", file=file) from None
    declared = _DECLARATION.match(text)
    return with_prefixes(text if declared is None else text[: declared.start(1)] + text[declared.end(1) :])


def with_prefixes(text: str) -> str:
    """Declare the prefixes that an XML document uses undeclared, such as ``gz:expressed_in``, in its outermost tag.

    The XML library of urdfdom, sdformat and MuJoCo takes a prefix for a part of the name. xacro's needs it declared, so
    that ``xacro:`` is left alone.
    """
    used = {tag or attribute for tag, attribute in _PREFIX.findall(text)} - {"xml", "xmlns", "xacro"}
    missing = sorted(prefix for prefix in used if not re.search(rf"\sxmlns:{re.escape(prefix)}\s*=", text))
    outermost = _OUTERMOST.match(text) if missing else None
    if outermost is None:
        return text
    declared = "".join(f' xmlns:{prefix}="{prefix}"' for prefix in missing)
    return text[: outermost.end()] + declared + text[outermost.end() :]

"""Files that a robot or a world is made of: read as bytes or as XML in any encoding, whatever stands at their path."""

import codecs
import re
import stat
from pathlib import Path

from drake_twin.errors import InputError

_MOST_BYTES = 1 << 30
_DECLARATION = re.compile(r"""^\s*<\?xml\b[^>]*?(\sencoding\s*=\s*["']([\w.:-]+)["'])[^>]*\?>""")
_MARKS = (
    (codecs.BOM_UTF32_LE, "utf-32"),
    (codecs.BOM_UTF32_BE, "utf-32"),
    (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
    (codecs.BOM_UTF8, "utf-8-sig"),
)


def check_regular(file: Path) -> None:
    """Refuses what is no file, as a device or a pipe, and what nobody would wait for.

    Raises:
        InputError: it is none, or too large.
        OSError: it is not there.
    """
    status = file.stat()
    if not stat.S_ISREG(status.st_mode):
        raise InputError("this is no file, but a folder, a device or a pipe", file=file)
    if status.st_size > _MOST_BYTES:
        raise InputError(f"the file has {status.st_size / 1e9:.1f} GB; a gigabyte is the most", file=file)


def read_xml(file: Path, what: str) -> str:
    """An XML file as text, in the encoding that its mark or its declaration names; the declaration says UTF-8 then.

    Args:
        file: the file.
        what: what it is, for the error.

    Raises:
        InputError: it cannot be read, or is not written in its encoding.
    """
    try:
        check_regular(file)
        data = file.read_bytes()
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
    return text if declared is None else text[: declared.start(1)] + text[declared.end(1) :]

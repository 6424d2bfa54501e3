"""Files of a robot or a world, read as bytes or as XML in any encoding; devices and huge files are refused."""

import codecs
import re
import stat
from pathlib import Path

from drake_twin.errors import InputError

_MOST_BYTES = 1 << 30
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


def check_regular(file: Path) -> None:
    """Check that a path is a regular file of reasonable size, and not a device or a pipe.

    Raises:
        InputError: If it is not a file, or too large.
        OSError: If it does not exist.
    """
    status = file.stat()
    if not stat.S_ISREG(status.st_mode):
        raise InputError("this is not a file, but a folder, a device or a pipe", file=file)
    if status.st_size > _MOST_BYTES:
        raise InputError(f"the file has {status.st_size / 1e9:.1f} GB; at most one gigabyte is read", file=file)


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

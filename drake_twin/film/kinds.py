"""The kinds of films: which files they are, and what they need."""

from importlib.util import find_spec
from pathlib import Path
from typing import NamedTuple

from drake_twin.errors import InputError
from drake_twin.requirements import missing

FILMS = (".mp4", ".webm", ".webp")
PICTURE = ".png"  # of the last moment
SUFFIXES = (*FILMS, PICTURE)
_MOST = 4096  # pixels of a picture's side
_FASTEST = 240.0  # pictures per second


class Format(NamedTuple):
    """What a film is made of.

    Attributes:
        size: The width and height of its pictures (pixels).
        rate: Pictures per second of simulation time.
    """

    size: tuple[int, int] = (1280, 720)
    rate: float = 30.0


def is_film(file: Path) -> bool:
    """Return whether a file's name is that of a film, or of a picture."""
    return file.suffix.lower() in SUFFIXES


def check_film(what: str, file: Path, form: Format) -> None:
    """Check before the run that a film can be made.

    Args:
        what: The option, for the error.
        file: The file.
        form: Its pictures.

    Raises:
        InputError: If the size or the rate is not possible, or what writes films is not installed.
    """
    width, height = form.size
    if not (16 <= width <= _MOST and 16 <= height <= _MOST):
        raise InputError(f"{what} {file}: pictures of {width}x{height} pixels: both sides must be from 16 to {_MOST}")
    if (width % 2 or height % 2) and file.suffix.lower() in FILMS:
        raise InputError(f"{what} {file}: pictures of {width}x{height} pixels: both sides of a film must be even")
    if not 1.0 <= form.rate <= _FASTEST:
        raise InputError(f"{what} {file}: {form.rate:g} pictures per second: there must be 1 to {_FASTEST:g}")
    if file.suffix.lower() in FILMS and find_spec("av") is None:
        raise missing(f"{what} {file} needs", "av", otherwise=f", or name a file {PICTURE} for a picture of the end")

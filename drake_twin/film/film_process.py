"""The process that draws and writes a film: ``python -m drake_twin.film.film_process``.

It is told by a `Connection` what there is to see and where, and ends when the other end of the connection closes. A
process of its own, since Drake's renderer holds the interpreter's lock, and since drawing takes as long as it takes.
"""

import os
import sys
from collections.abc import Iterator
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from drake_twin.film.camera import Camera
from drake_twin.film.encoder import encode
from drake_twin.film.kinds import PICTURE, Format
from drake_twin.film.stage import Stage
from drake_twin.python_process import ignore_stops
from drake_twin.sensors.cameras.render_process import NoOpenGLError

READY, NO_OPENGL, FAILED, DONE = "ready", "no OpenGL", "failed", "done"


def pictures(link: Any, form: Format, suffix: str) -> Iterator[np.ndarray]:
    """Yield the pictures of what is told, until the end is; of a picture's file, the last one alone."""
    stage: Stage | None = None
    camera = Camera(form.size, form.rate)
    last: np.ndarray | None = None
    while True:
        kind, *values = link.recv()
        if kind == "end":
            break
        if kind == "scene":
            stage = None  # its memory first
            stage = Stage(*values)
            link.send((READY, ""))
        elif suffix == PICTURE:
            (last,) = values
        else:
            assert stage is not None, "a picture without a scene"
            yield stage.picture(camera, *values)
    if last is not None and stage is not None:
        yield stage.picture(camera, last)


def main(connection: str, file: str) -> None:
    """Write a film; say what goes wrong to who has asked.

    Args:
        connection: The number of the connection's file.
        file: That of the film.
    """
    ignore_stops()
    link: Any = Connection(int(connection))
    try:
        suffix, form = link.recv()
        with os.fdopen(int(file), "wb", closefd=False) as stream:
            encode(pictures(link, form, suffix), stream, suffix, form.rate)
        link.send((DONE, ""))
    except EOFError:
        return
    except NoOpenGLError as error:
        link.send((NO_OPENGL, _text(error)))
    except Exception as error:
        link.send((FAILED, _text(error)))


def _text(error: Exception) -> str:
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return " ".join(str(error).split()) or type(error).__name__


if __name__ == "__main__":
    main(*sys.argv[1:])

"""Writes pictures into a film."""

from collections.abc import Iterator
from fractions import Fraction
from typing import Any, BinaryIO, NamedTuple

import numpy as np

from drake_twin.film.kinds import PICTURE


class _Kind(NamedTuple):
    """How a kind of film is written: FFmpeg's names of the container, the encoder and the pixels, and its options."""

    container: str
    codec: str
    pixels: str
    options: dict[str, str]
    of_container: dict[str, str] = {}  # noqa: RUF012 (of a tuple)


_ONE_THREAD = {"threads": "1"}  # so that the file is the same on every machine
_KINDS = {
    ".mp4": _Kind("mp4", "libx264", "yuv420p", {"crf": "20", "preset": "fast", **_ONE_THREAD}),
    ".webm": _Kind(
        "webm", "libvpx-vp9", "yuv420p", {"crf": "30", "b": "0", "deadline": "good", "cpu-used": "5", **_ONE_THREAD}
    ),
    ".webp": _Kind("webp", "libwebp_anim", "yuv420p", {"quality": "82", **_ONE_THREAD}, {"loop": "0"}),
}


def encode(pictures: Iterator[np.ndarray], stream: BinaryIO, suffix: str, rate: float) -> None:
    """Write pictures as a film, or the last of them as a picture.

    Args:
        pictures: The pictures, (height, width, 3), 8 bits each; one at least.
        stream: Is written; it can be sought in.
        suffix: The end of the file's name, one of `drake_twin.film.kinds.SUFFIXES`.
        rate: Pictures per second.

    Raises:
        OSError: If the stream cannot be written.
    """
    if suffix == PICTURE:
        from PIL import Image

        *_, last = pictures
        Image.fromarray(last).save(stream, "png", optimize=True)
        return
    import av

    kind = _KINDS[suffix]
    first = next(pictures)
    height, width, _ = first.shape
    frequency = Fraction(rate).limit_denominator(1001)
    with av.open(stream, "w", format=kind.container, options=kind.of_container) as container:
        track: Any = container.add_stream(kind.codec, rate=frequency, options=kind.options)
        track.width, track.height, track.pix_fmt = width, height, kind.pixels
        for number, picture in enumerate(_chained(first, pictures)):
            frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
            frame.pts, frame.time_base = number, 1 / frequency
            container.mux(track.encode(frame))
        container.mux(track.encode())


def _chained(first: np.ndarray, others: Iterator[np.ndarray]) -> Iterator[np.ndarray]:
    yield first
    yield from others

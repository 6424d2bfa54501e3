"""What is asked of the process that draws."""

from typing import NamedTuple

COLOR, DEPTH, LABEL = "color", "depth", "label"
NO_OPENGL, NO_SCENE = -1, 0  # in the place of a picture's number, where all pictures fail
_BYTES = {COLOR: 3, DEPTH: 4, LABEL: 2}  # of a pixel


class View(NamedTuple):
    """A picture to draw.

    Attributes:
        kind: ``color`` (red, green, blue; 8 bits each), ``depth`` (m, float32; -inf where something is too near, inf
            where nothing is) or ``label`` (16 bits; 0 for nothing).
        width: In pixels.
        height: In pixels.
        intrinsics: fx, fy, cx, cy (pixels).
        near: What is nearer is not seen (m).
        far: What is farther is not seen (m).
    """

    kind: str
    width: int
    height: int
    intrinsics: tuple[float, float, float, float]
    near: float
    far: float

    @property
    def size(self) -> int:
        """The picture's size (bytes)."""
        return self.width * self.height * _BYTES[self.kind]

"""OBJ files, examined before Drake's reader has them: it fails at an index that is out of range."""

import numpy as np

from drake_twin.values import LARGEST


def obj_is_sound(content: bytes) -> bool:
    """Tell whether an OBJ file has corners in space, more than one, and faces of corners that it has.

    Args:
        content: The file's bytes.
    """
    counts = {b"v": 0, b"vt": 0, b"vn": 0}
    corners: list[list[bytes]] = []
    has_faces = False
    for line in content.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines():
        words = line.partition(b"#")[0].split()
        if not words:
            continue
        if words[0] in counts:
            counts[words[0]] += 1
            if words[0] == b"v":
                corners.append(words[1:4])
        elif words[0] == b"f":
            has_faces = True
            if len(words) < 4 or not all(_is_corner(word, counts) for word in words[1:]):
                return False
    try:
        points = np.array(corners, dtype=float)
    except ValueError:
        return False
    is_in_space = points.shape[1:] == (3,) and bool((np.abs(points) < LARGEST).all())
    return has_faces and len(points) > 2 and is_in_space and bool(np.ptp(points, axis=0).any())


def _is_corner(word: bytes, counts: dict[bytes, int]) -> bool:
    """Tell whether a face's corner, ``v/vt/vn``, has indexes of what stands before it in the file."""
    parts = word.split(b"/")
    try:
        return len(parts) <= 3 and all(
            1 <= abs(int(part)) <= count
            for part, count in zip(parts, counts.values(), strict=False)
            if part or part is parts[0]
        )
    except ValueError:
        return False

"""A box with a camera, and whether pictures can be drawn here."""

import subprocess
import sys
from functools import cache

import numpy as np
import pytest
from rig import on_box, twin_with

_PROBE = """
import numpy as np
from drake_twin.sensors.cameras.render_process import Painter
from drake_twin.sensors.cameras.picture import View
from drake_twin.sensors.cameras.scene import SeenScene
pose = np.eye(4)[np.newaxis, :3]
Painter(SeenScene((), ())).draw(View("color", 8, 8, (8.0, 8.0, 4.0, 4.0), 0.1, 10.0), pose)
"""


@cache
def can_draw():
    """Whether Mesa is here: without it VTK ends the process."""
    return subprocess.run([sys.executable, "-c", _PROBE], capture_output=True, check=False).returncode == 0


def need_mesa():
    if not can_draw():
        pytest.skip("pictures need Mesa: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri")


def camera(
    kind="camera",
    size=(64, 48),
    fov=1.0,
    pose="0 0 1 0 0 0",
    rate=10,
    more="",
    clip="<near>0.05</near><far>20</far>",
    topic="cam/image",
    plugin="",
    name="s",
):
    """A camera on a box, by default one meter above it, looking along x."""
    width, height = size
    picture = f"<image><width>{width}</width><height>{height}</height></image><clip>{clip}</clip>"
    inside = f"<pose>{pose}</pose><topic>{topic}</topic><update_rate>{rate}</update_rate>"
    lens = f"<camera><horizontal_fov>{fov}</horizontal_fov>{picture}{more}</camera>{plugin}"
    return on_box(kind, inside + lens, name)


def ball(position, radius=0.02, color="1 0 0", name="ball"):
    """A static ball that is only seen."""
    return seen(f"<sphere><radius>{radius}</radius></sphere>", position, color, name)


def seen(shape, position, color="1 0 0", name="thing", turn="0 0 0"):
    """A static shape that is only seen."""
    place = " ".join(f"{value:.9g}" for value in position)
    return (
        f'<model name="{name}"><static>true</static><pose>{place} {turn}</pose><link name="l"><visual name="v">'
        f"<geometry>{shape}</geometry><material><diffuse>{color} 1</diffuse></material></visual></link></model>"
    )


def centroid(mask):
    """The mean column and row of the pixels of a mask."""
    rows, columns = np.nonzero(mask)
    assert len(rows) > 3, "too few pixels"
    return np.array([columns.mean(), rows.mean()])


def heard(twin, topic, until=0.25):
    found = []
    twin.subscribe(topic, found.append)
    twin.advance_to(until)
    return found


__all__ = ["ball", "camera", "centroid", "heard", "need_mesa", "on_box", "seen", "twin_with"]

"""Whether pictures can be drawn here."""

import subprocess
import sys
from functools import cache

import pytest

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

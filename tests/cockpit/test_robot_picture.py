"""The picture of a robot that is not in the twin yet, against the projection of a sphere."""

import base64
import io
import json
import os
import subprocess
import sys
from math import asin, sin, sqrt, tan

import numpy as np
import pytest
from PIL import Image

SPHERE = """<robot name="ball"><link name="ball">
<visual><geometry><sphere radius="0.5"/></geometry><material name="m"><color rgba="1 0 0 1"/></material></visual>
<collision><geometry><sphere radius="0.5"/></geometry></collision></link></robot>"""


def drawn(file):
    """What the process that draws a robot prints."""
    program = [
        sys.executable,
        "-m",
        "drake_twin.cockpit.robot_picture",
        str(os.getpid()),
        str(file),
        json.dumps([{}, []]),
    ]
    return subprocess.run(program, capture_output=True, text=True, check=False)


def test_a_robot_is_in_the_middle_and_fits_into_the_picture(tmp_path):
    """The camera is 1.05 radii of the box about it over the sine of half its view's height away; the sphere is less."""
    (tmp_path / "ball.urdf").write_text(SPHERE)
    result = drawn(tmp_path / "ball.urdf")
    if result.returncode != 0:
        pytest.skip(f"pictures need Mesa: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri ({result.stderr})")
    picture = np.asarray(Image.open(io.BytesIO(base64.b64decode(result.stdout)))).astype(int)
    assert picture.shape == (240, 320, 3)
    rows, columns = np.nonzero(picture[:, :, 0] > picture[:, :, 1] + 30)
    distance = 1.05 * sqrt(3) * 0.5 / sin(0.4)
    radius = 120 / tan(0.4) * tan(asin(0.5 / distance))  # pixels
    assert (columns.min() + columns.max()) / 2 == pytest.approx(159.5, abs=1)
    assert (rows.min() + rows.max()) / 2 == pytest.approx(119.5, abs=1)
    assert columns.max() - columns.min() == pytest.approx(2 * radius, abs=3)
    assert rows.max() - rows.min() == pytest.approx(2 * radius, abs=3)


def test_what_is_wrong_with_a_file_is_said_and_no_picture(tmp_path):
    (tmp_path / "ball.urdf").write_text("<robot")
    result = drawn(tmp_path / "ball.urdf")
    assert (result.returncode, result.stdout) == (2, "")
    assert "ball.urdf" in result.stderr
    assert "Traceback" not in result.stderr

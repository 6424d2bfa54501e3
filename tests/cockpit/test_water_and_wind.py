"""What is drawn of water and wind: surfaces once, and an arrow where the wind has changed."""

import numpy as np
import pytest
import umsgpack
from waters import layers
from winds import blown, effects

from drake_twin.cockpit.overlay import OVERLAY_KINDS
from drake_twin.cockpit.scene import Scene

FLUIDS = "/overlays/fluids"


def drawn(twin):
    """The overlay, and what it has sent so far: path → kinds and contents of commands."""
    scene, sent = Scene(), []
    scene.listen(lambda commands: sent.extend(commands))
    shown = OVERLAY_KINDS["fluids"].type(scene, twin)
    return scene, shown, sent


def pose(scene, path):
    (content,) = [
        content for kind, at, content in scene.everything() if (kind, at.decode()) == (b"set_transform", path)
    ]
    return np.array(umsgpack.unpackb(content)["matrix"]).reshape(4, 4).T


def label(scene):
    (content,) = [content for _, at, content in scene.everything() if at.decode() == f"{FLUIDS}/speed"][-1:]
    return umsgpack.unpackb(content)["object"]["object"]["userData"]["label"]


def test_a_surface_is_where_the_density_changes(tmp_path):
    twin = blown(tmp_path, layers((-2.0, 1000.0), (1.5, 1.2), (3.0, 0.5)), wind="0 0 0")
    scene, shown, sent = drawn(twin)
    shown.draw()
    paths = sorted(path for path in scene.everything().paths() if path.startswith(FLUIDS))
    assert [pose(scene, path)[2, 3] for path in paths] == pytest.approx([1.5, 3.0], abs=0.002)  # below -2 is the same
    count = len(sent)
    twin.advance_to(0.1)
    shown.draw()
    assert len(sent) == count


def test_one_fluid_without_wind_has_nothing_to_draw(tmp_path):
    scene, shown, sent = drawn(blown(tmp_path, layers(), wind="0 0 0"))
    shown.draw()
    assert sent == []
    assert not scene.has_path(FLUIDS)


def test_a_steady_wind_is_sent_once_as_an_arrow_of_its_speed(tmp_path):
    twin = blown(tmp_path, "", wind="3 4 0")
    scene, shown, sent = drawn(twin)
    shown.draw()
    along = pose(scene, f"{FLUIDS}/wind")[:3, 2]
    assert along == pytest.approx([0.6, 0.8, 0.0])
    assert pose(scene, f"{FLUIDS}/wind/shaft")[2, 2] == pytest.approx(1.0)  # 5 m/s
    assert label(scene) == "wind 5.0 m/s"
    count = len(sent)
    twin.advance_to(0.1)
    shown.draw()
    assert len(sent) == count
    shown.remove()
    assert not scene.has_path(FLUIDS)


def test_a_wind_that_changes_is_drawn_as_it_is(tmp_path):
    twin = blown(tmp_path, effects(rise=0.5, turn=1e-9), 0.01, wind="10 0 0")
    scene, shown, _ = drawn(twin)
    shown.draw()
    assert not scene.has_path(FLUIDS)
    twin.advance_to(1.0)
    shown.draw()
    speed = 10 * (1 - np.exp(-2))
    assert label(scene) == f"wind {speed:.1f} m/s"
    assert pose(scene, f"{FLUIDS}/wind/shaft")[2, 2] == pytest.approx(speed / 5)
    twin.publish("/world/w/wind", {"x": 0.0, "y": -10.0, "z": 0.0})
    twin.advance_to(1.01)
    shown.draw()
    assert pose(scene, f"{FLUIDS}/wind")[:3, 2] == pytest.approx([0, -1, 0], abs=1e-6)

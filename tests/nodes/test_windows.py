"""OpenCV's windows in nodes, with an OpenCV that has none: ``opencv-python-headless``, or no display."""

import os
import sys

import pytest
from node_runs import lines, running, script

from drake_twin.findings import Kind

# What its windows do in opencv-python-headless 5.0 (highgui/src/window.cpp); with a display, other errors go on.
OPENCV = """
class error(Exception):
    pass

def _none(*arguments, **options):
    raise error("window.cpp:1262: error: (-2:Unspecified error) The function is not implemented. Rebuild the library")

imshow = namedWindow = waitKey = createTrackbar = getTrackbarPos = getWindowProperty = destroyAllWindows = _none

def flip(image, code):
    return image[::-1]
"""
LOOKS = """
import time, cv2

cv2.namedWindow("view")
cv2.createTrackbar("hue", "view", 7, 255, None)
for count in range(3):
    image = cv2.flip([count, 9], 0)
    cv2.imshow("view", image)
    assert cv2.waitKey(100) & 0xFF != ord("q")
    assert cv2.getWindowProperty("view", 4) >= 1
print(image, cv2.getTrackbarPos("hue", "view"), f"{time.time():.1f}")
cv2.destroyAllWindows()
"""


@pytest.fixture
def opencv(tmp_path, monkeypatch):
    """An OpenCV that cannot open windows."""
    script(tmp_path / "site", "cv2.py", OPENCV)
    monkeypatch.syspath_prepend(tmp_path / "site")
    monkeypatch.delitem(sys.modules, "cv2", raising=False)
    yield
    sys.modules.pop("cv2", None)


@pytest.mark.parametrize("display", ["", ":0"])
def test_a_loop_around_a_window_goes_on_in_simulation_time(opencv, display, tmp_path, capsys, monkeypatch):
    monkeypatch.setenv("DISPLAY", display)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    with running(script(tmp_path, "looks.py", LOOKS)) as twin:
        twin.advance_to(1.0)
        found = [item for item in twin.more_findings if item.kind is Kind.IGNORED]
        assert len(found) == 1  # for three images
        assert "looks.py:8" in found[0].what
        assert twin.more_findings == found
    assert lines(capsys) == ["[9, 2] 7 0.3"]


def test_other_threads_have_opencvs_own_windows(opencv, tmp_path, monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    with running(script(tmp_path, "looks.py", LOOKS)) as twin:
        twin.advance_to(1.0)
        cv2 = sys.modules["cv2"]
        with pytest.raises(cv2.error, match="not implemented"):
            cv2.imshow("view", [])


def test_a_mistake_of_the_nodes_is_an_error_as_before(opencv, tmp_path, monkeypatch):
    monkeypatch.setenv("DISPLAY", ":0")
    (tmp_path / "site" / "cv2.py").write_text(OPENCV.replace("The function is not implemented", "size.width>0"))
    with running(script(tmp_path, "looks.py", LOOKS)) as twin:
        twin.advance_to(1.0)
        assert [item.kind for item in twin.more_findings] == [Kind.FAILED]
        assert "size.width>0" in twin.more_findings[0].what


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere there is always a display")
@pytest.mark.parametrize(("display", "platform"), [("", "offscreen"), (":0", None)])
def test_qt_draws_into_memory_without_a_display(tmp_path, capsys, monkeypatch, display, platform):
    """It reads the variable from the process itself, and aborts that without a display."""
    monkeypatch.setenv("DISPLAY", display)
    for name in ("WAYLAND_DISPLAY", "QT_QPA_PLATFORM"):
        monkeypatch.delenv(name, raising=False)
    script(tmp_path, "PyQt5/__init__.py", "")
    script(tmp_path, "PyQt5/QtWidgets.py", "")
    text = "import ctypes\nfrom PyQt5 import QtWidgets\nget = ctypes.CDLL(None).getenv\nget.restype = ctypes.c_char_p\n"
    file = script(tmp_path, "f.py", f"{text}print((get(b'QT_QPA_PLATFORM') or b'').decode() or None)\n")
    try:
        with running(file) as twin:
            twin.advance_to(0.1)
            said = [item.what for item in twin.findings]
    finally:
        os.unsetenv("QT_QPA_PLATFORM")
    assert lines(capsys) == [str(platform)]
    what = f"node f.py: no window shows what PyQt5 draws, without a display ({file}:2)"
    assert said == ([what] if platform else [])

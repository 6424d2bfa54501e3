"""The scene is drawn with fewer pixels while pictures come too slowly; its clock and its graphics card are false."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, page, show
from conftest import rovers

pytestmark = BROWSER_TESTS

STEPS = [1, 0.7, 0.5, 0.4]  # of the screen's pixels, along each side
MANY = 8  # pictures that a step needs at least

# Draws nothing, and tells the page's own loop nothing: `frames` below is all that draws and all that passes time.
FALSE_CLOCK = """({ contentWindow: scene }) => {
  const { shownViewer: viewer } = scene;
  const gl = viewer.renderer.getContext();
  scene.own = viewer.animate;
  viewer.animate = () => {};
  scene.now = scene.performance.now() + 1e6;
  scene.performance.now = () => scene.now;
  scene.isBusy = false;
  gl.fenceSync = () => "fence";
  gl.getSyncParameter = () => (scene.isBusy ? 0 : gl.SIGNALED);
  gl.deleteSync = () => {};
  scene.pictures = 0;
  viewer.render = () => {
    scene.pictures++;
    viewer.needs_render = false;
  };
}"""

FRAMES = """({ contentWindow: scene }, { count, apart, isMoving }) => {
  const before = scene.pictures;
  for (let frame = 0; frame < count; frame++) {
    scene.now += apart;
    if (isMoving) scene.shownViewer.set_dirty();
    scene.own();
  }
  return [scene.shownViewer.sharpness ?? 1, scene.pictures - before];
}"""


@pytest.fixture
def frames(page):
    """Runs frames so many ms apart; returns the share of pixels and the number of pictures. All were fast before."""
    _, tab = page
    scene = tab.locator("#scene")
    scene.evaluate(FALSE_CLOCK)

    def run(count, apart, *, moving=True):
        return tuple(scene.evaluate(FRAMES, {"count": count, "apart": apart, "isMoving": moving}))

    run.scene = scene
    run(10 * MANY, 16)
    return run


def slowed(frames, share):
    """Let pictures come slowly until they have this share of the pixels."""
    assert any(frames(1, 100)[0] == share for _ in range(10 * MANY))


def test_slow_pictures_have_fewer_pixels_step_by_step(frames):
    shares = [frames(1, 100)[0] for _ in range(10 * MANY)]
    assert list(dict.fromkeys(shares)) == STEPS
    assert all(shares.count(share) >= MANY for share in STEPS)


def test_fast_pictures_have_more_again(frames):
    slowed(frames, STEPS[-1])
    shares = [frames(1, 16)[0] for _ in range(10 * MANY)]
    assert list(dict.fromkeys(shares)) == STEPS[::-1]


def test_pictures_of_a_middling_rate_stay_as_they_are(frames):
    slowed(frames, 0.5)
    assert frames(10 * MANY, 50) == (0.5, 10 * MANY)


def test_once_nothing_moves_each_pixel_is_drawn_once(frames):
    slowed(frames, 0.5)
    assert frames(3, 100, moving=False) == (0.5, 0)
    assert frames(2, 100, moving=False) == (1, 1)
    assert frames(20, 100, moving=False) == (1, 0)
    assert frames(1, 100) == (0.5, 1)  # and it is as fast as before at once when something moves


def test_a_rest_between_two_pictures_is_not_slowness(frames):
    for _ in range(3 * MANY):
        frames(1, 16)
        assert frames(18, 16, moving=False)[0] == 1


def test_a_picture_waits_for_the_one_before(frames):
    frames(1, 20)
    frames.scene.evaluate("({ contentWindow: scene }) => { scene.isBusy = true; }")
    assert frames(10, 20) == (1, 0)
    frames.scene.evaluate("({ contentWindow: scene }) => { scene.isBusy = false; }")
    assert frames(1, 20) == (1, 1)


def test_a_film_has_each_pixel(frames):
    slowed(frames, 0.5)
    frames.scene.evaluate("({ contentWindow: scene }) => { scene.end = scene.sceneTools.drawWhole(); }")
    assert frames(1, 100) == (1, 1)
    frames.scene.evaluate("({ contentWindow: scene }) => { scene.end(); }")
    assert frames(1, 100) == (0.5, 1)

"""What tests do in the scene's frame: ask its tools, and find places on the page."""


def item(tab, node):
    """The tree's row of a node."""
    return tab.locator(f'[role=treeitem][data-node="{node}"]')


def tools(tab, expression):
    """The value of an expression of the scene's tools, such as ``handles.pose``."""
    return tab.locator("#scene").evaluate(f"(frame) => frame.contentWindow.sceneTools.{expression}")


def place_of(tab, point):
    """Where a point of the world (m) is on the page (pixels)."""
    at = tools(tab, f"onPicture({list(point)})")
    box = tab.locator("#scene").bounding_box()
    return box["x"] + at["x"], box["y"] + at["y"]


def look_at(tab, *paths):
    """Let the camera show robots and models from its first angle, and stay there."""
    assert tools(tab, f"fit({list(paths)}, [0.75, -0.65, 0.4])")
    tools(tab, "isTouched = true")

"""A box with a camera, and whether pictures can be drawn here."""

import numpy as np
from mesa import need_mesa
from rig import on_box, twin_with


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

"""Frames that files name and that are most likely a misspelt link of the robot."""

from collections.abc import Collection

from drake_twin.errors import did_you_mean

_CLOSE = 0.85


def misspelt_frame(frame: str, links: Collection[str]) -> str | None:
    """Say that the robot has no link of a frame's name, but one that is close; None for any other frame.

    A frame that is not a link may be published by a node, so that only a close name is worth a finding. Prefixes
    before a link's name count for nothing, as files have them on one side only.

    Args:
        frame: The frame as written.
        links: The robot's links.
    """
    name = frame.strip().lstrip("/")
    if not name or any(_is_same(name, link) for link in links):
        return None
    hint = did_you_mean(name, links, _CLOSE)
    return f"the robot has no link {name!r}{hint}" if hint else None


def _is_same(name: str, link: str) -> bool:
    return name == link or name.endswith(("/" + link, "_" + link)) or link.endswith(("/" + name, "_" + name))

"""Where launch files construct their entities."""

import sys
from pathlib import Path

from drake_twin.findings import Place

_OWN_FOLDER = str(Path(__file__).parent)


def place_of_caller() -> Place | None:
    """Return the line, outside of this package, that led to the call."""
    frame = sys._getframe(1)
    while frame is not None:
        file = frame.f_code.co_filename
        if not file.startswith((_OWN_FOLDER, "<")):
            return Place(file, frame.f_lineno)
        frame = frame.f_back  # type: ignore[assignment]
    return None

"""The option ``--save-html``: the run as one page that plays back offline."""

import contextlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from drake_twin.whole_file import write_result

if TYPE_CHECKING:
    from drake_twin.cockpit.scene import Scene
    from drake_twin.twin.twin import Twin


@contextlib.contextmanager
def html_file(twin: "Twin", scene: "Scene | None", file: Path | None) -> Iterator[None]:
    """Record what happens inside the block and write it as HTML, also if the block raises an error.

    Args:
        twin: The twin.
        scene: The scene of the program's page, if it has one.
        file: The file; None to record nothing.

    Raises:
        RunError: If the file cannot be written.
    """
    if file is None:
        yield
        return
    from drake_twin.cockpit.html_recording import HtmlRecording
    from drake_twin.cockpit.scene import Scene

    scene = scene or Scene()
    if not scene.everything():
        scene.set_up(twin)
    recording = HtmlRecording(scene, twin)
    try:
        yield
    finally:
        write_result("page", file, recording.finish())

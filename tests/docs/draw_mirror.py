"""Draws a mirror's report: ``python tests/docs/draw_mirror.py drake_twin/docs/mirror.png``.

The report is that of the documentation's page, whose commands are done in a temporary folder.
"""

import contextlib
import io
import os
import shlex
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))  # of the tests' own modules

from chromium import CHROMIUM, OFFLINE, SOFTWARE_RENDERING
from docs import run_page
from PIL import Image

from drake_twin import run
from drake_twin.mirror import __main__ as mirror

PAGE = Path(__file__).resolve().parents[2] / "drake_twin" / "docs" / "mirror.md"
SIZE = {"width": 620, "height": 760}
COLORS = 64
PROGRAMS = {"drake_twin.run": run.main, "drake_twin.mirror": mirror.main}


def done(folder: Path) -> list[int]:
    """Do what the page says about bags in a folder, and return the exit codes of its commands."""
    codes = []
    with contextlib.chdir(folder):
        for block in run_page.blocks(PAGE):
            if block.file is not None:
                Path(block.file).write_text(block.text, encoding="utf-8")
            for line in block.text.splitlines() if block.language == "sh" else ():
                words = shlex.split(line)
                if "--bag" in words:
                    codes.append(PROGRAMS[words[2]](words[3:]))
    return codes


def draw(file: Path) -> None:
    """Draw the report of the page into a PNG."""
    from playwright.sync_api import sync_playwright

    with TemporaryDirectory() as name:
        assert done(Path(name)) == [0, 0, 0, 3]
        with sync_playwright() as playwright:
            browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_RENDERING + OFFLINE)
            tab = browser.new_page(viewport=SIZE)
            tab.goto((Path(name) / "today.html").as_uri())
            picture = Image.open(io.BytesIO(tab.screenshot()))
            browser.close()
    picture.convert("RGB").quantize(COLORS).save(file, optimize=True)
    print(f"wrote {file} ({os.path.getsize(file)} bytes)")


if __name__ == "__main__":
    draw(Path(sys.argv[1]))

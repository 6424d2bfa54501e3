"""A release has one version, and its papers agree with it."""

import re
import tomllib
from datetime import date
from pathlib import Path

import yaml

from drake_twin import __version__

ROOT = Path(__file__).resolve().parent.parent
CHANGELOG = (ROOT / "drake_twin" / "docs" / "changelog.md").read_text(encoding="utf-8")


def releases() -> list[tuple[str, str]]:
    """The changelog's versions with their dates, newest first; what is not released yet stands above them."""
    headings = re.findall(r"^## (.+)$", CHANGELOG, re.MULTILINE)
    if headings[0] == "Unreleased":
        del headings[0]
    return [re.fullmatch(r"(\S+)(?: \((.+)\))?", heading).groups(default="") for heading in headings]


def test_the_newest_version_of_the_changelog_is_the_version():
    assert re.fullmatch(r"\d+\.\d+\.\d+((a|b|rc)\d+)?", __version__)
    version, day = releases()[0]
    assert version == __version__
    assert date.fromisoformat(day)


def test_what_is_not_released_yet_is_not_empty():
    assert not re.search(r"^## Unreleased\s+^## ", CHANGELOG, re.MULTILINE)


def test_the_citation_is_of_this_version():
    citation = yaml.safe_load((ROOT / ".github" / "CITATION.cff").read_text(encoding="utf-8"))
    assert (citation["version"], str(citation["date-released"])) == releases()[0]


def test_the_workflow_tests_each_version_of_python_that_is_named():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    named = [item.rpartition(" ")[2] for item in project["classifiers"] if ":: Python :: 3." in item]
    jobs = yaml.safe_load((ROOT / ".github" / "workflows" / "tests.yml").read_text(encoding="utf-8"))["jobs"]
    assert jobs["platforms"]["strategy"]["matrix"]["python"] == named
    assert project["requires-python"] == f">={named[0]}"


def test_actions_are_pinned_by_their_commit():
    for file in (ROOT / ".github" / "workflows").iterdir():
        used = re.findall(r"uses: (.+)", file.read_text(encoding="utf-8"))
        assert used
        assert all(re.fullmatch(r"[\w./-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", text) for text in used)

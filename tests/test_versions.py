"""Every file that is written says its version and what wrote it; later versions are refused in words."""

import json
import logging
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest
import yaml

import drake_twin
from drake_twin import InputError, Recording, Robot, Scenario, Snapshot, TwinBuilder
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml
from drake_twin.sweeps.results import read_table
from drake_twin.versions import FILE_KINDS, SCENARIO, rows, stamp, written_by

ARM = "package://arduinobot_description/urdf/arduinobot.urdf.xacro"
PACKAGE = Path(drake_twin.__file__).parent
# Modules that write files → the kinds that they write; those without one are said why.
WRITERS = {
    "benchmarks/plots.py": "a picture",
    "benchmarks/report.py": "what was measured, with the machine's versions",
    "calibration/report.py": "fitted scenario",
    "cli/html_file.py": "page",
    "cli/plot.py": "a picture",
    "cli/results.py": "summary",
    "description/lasting_files.py": "a robot's own text, named by its digest",
    "description/mesh_cache.py": "converted mesh",
    "description/xacro_cache.py": "expanded xacro file",
    "diagram/picture.py": "a picture",
    "film/film.py": "a film",
    "mirror/learner.py": "fitted scenario",
    "mirror/report.py": "mirror's report",
    "ros2/xacro_program.py": "what xacro writes",
    "sweeps/report.py": "a picture",
    "sweeps/results.py": "sweep's table",
    "twin/saved_file.py": "saved state",
    "wires/bag_writer.py": "bag",
}


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    """A folder with one file of each kind that a run writes."""
    folder = tmp_path_factory.mktemp("written")
    options = ["--save-state", "state.json", "--record", "record.json", "--summary", "summary.json"]
    options += ["--save-html", "page.html", "--bag", "bag", "--duration", "0.05", "--headless", "--robots", "1"]
    sweep = ["it.yaml", "--seeds", "2", "--duration", "0.02", "--workers", "1", "--out"]
    (folder / "it.yaml").write_text(scenario_to_yaml(Scenario((Robot("arm", ARM),), time_step=0.01)))
    for program, arguments in (("run", options), ("sweep", [*sweep, "table.csv"]), ("sweep", [*sweep, "table.jsonl"])):
        command = [sys.executable, "-m", f"drake_twin.{program}", *arguments]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, check=False)
        assert run.returncode == 0, run.stdout + run.stderr
    return folder


def test_the_stamp_has_the_versions_of_the_promise():
    assert written_by()["drake"] == version("drake")
    assert stamp() == f"drake_twin {drake_twin.__version__} (Drake {version('drake')}, {written_by()['machine']})"


@pytest.mark.parametrize("name", ["state.json", "record.json", "summary.json"])
def test_files_of_json_have_version_and_writer_at_their_top(written, name):
    data = json.loads((written / name).read_text())
    assert list(data)[:3] == ["format", "version", "written_by"]
    (kind,) = (kind for kind in FILE_KINDS if f"drake_twin {kind.what}" == data["format"])
    assert (data["version"], data["written_by"]) == (kind.version, written_by())


def test_bags_pages_and_tables_say_what_wrote_them(written):
    metadata = yaml.safe_load((written / "bag" / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert (metadata["version"], metadata["custom_data"]) == (9, {"written_by": stamp()})
    assert f'<meta name="generator" content="{stamp()}">' in (written / "page.html").read_text()
    for name in ("table.csv", "table.jsonl"):
        definition, found = read_table(written / name)
        assert (definition["format"], {row["version"] for row in found}) == (1, {stamp()})


@pytest.mark.parametrize(
    ("name", "load"), [("state.json", Snapshot.load), ("record.json", Recording.load)], ids=["state", "recording"]
)
def test_later_versions_are_refused_and_older_ones_are_read(written, tmp_path, name, load):
    data = json.loads((written / name).read_text())
    file = tmp_path / name
    older = {key: value for key, value in data.items() if key != "written_by"} | {"version": 2}
    file.write_text(json.dumps(older))
    assert load(file) == load(written / name)
    for wrong, later in (
        (4, True),
        (10**9, True),
        (0, False),
        ("3", False),
        (True, False),
        (None, False),
        (2.0, False),
    ):
        file.write_text(json.dumps(data | {"version": wrong}))
        with pytest.raises(InputError, match=rf"has version {wrong!r}; 1 to 3 can be read") as caught:
            load(file)
        assert ("a later drake_twin wrote it, and this is drake_twin" in str(caught.value)) == later


def test_another_drake_is_said(written, tmp_path, caplog):
    data = json.loads((written / "state.json").read_text())
    Snapshot.load(written / "state.json")
    assert caplog.messages == []
    file = tmp_path / "state.json"
    file.write_text(json.dumps(data | {"written_by": written_by() | {"drake": "9.9"}}))
    with caplog.at_level(logging.WARNING):
        Snapshot.load(file)
    (message,) = caplog.messages
    assert message.startswith(f"the saved state {file} is of Drake 9.9 on ")


@pytest.mark.parametrize("name", ["table.csv", "table.jsonl"])
def test_a_later_table_is_refused_and_one_without_a_version_is_read(written, tmp_path, name):
    text, file = (written / name).read_text(), tmp_path / name
    file.write_text(text.replace('"format": 1, ', ""))
    assert read_table(file)[1] == read_table(written / name)[1]
    file.write_text(text.replace('"format": 1, ', '"format": 2, '))
    with pytest.raises(InputError, match="the sweep's table has version 2; 1 can be read: a later drake_twin wrote it"):
        read_table(file)


def test_scenarios_have_a_version_that_may_be_left_out():
    text = scenario_to_yaml(Scenario((Robot("arm", ARM),)))
    assert text.startswith(f"version: {SCENARIO.version}\n")
    without = text.partition("\n")[2]
    assert ScenarioFile(text, "a.yaml").scenario == ScenarioFile(without, "a.yaml").scenario
    with pytest.raises(InputError, match=r"a\.yaml:1: .*the scenario has version 2; 1 can be read: a later drake_twin"):
        ScenarioFile(f"version: 2\n{without}", "a.yaml")


def test_a_saved_state_of_now_has_a_scenario_with_a_version():
    with TwinBuilder().robot("arm", ARM).build() as twin:
        assert twin.snapshot().scenario.startswith("version: ")


def test_the_page_of_files_has_every_kind():
    page = (PACKAGE / "docs" / "files.md").read_text(encoding="utf-8")
    table = [line for line in page.splitlines() if line.startswith("| ")][1:]
    assert table == list(rows())


def test_every_module_that_writes_a_file_has_a_kind():
    files = {str(file.relative_to(PACKAGE)): file.read_text(encoding="utf-8") for file in PACKAGE.rglob("*.py")}
    found = {name for name, text in files.items() if "\nfrom drake_twin.whole_file import " in text}
    assert found == set(WRITERS)
    kinds = {kind.what for kind in FILE_KINDS}
    assert {what for what in WRITERS.values() if not what.startswith(("a ", "what "))} <= kinds

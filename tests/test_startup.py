"""What a start imports and compiles, as counts: each module takes 0.3 ms, each method of a dataclass 0.1 ms."""

import json
import os
import subprocess
import sys

import pytest

LOOK = """
import json, sys
compiled = []
sys.addaudithook(lambda event, words: event == "compile" and compiled.append(words[1]))
from drake_twin.run import main
code = main([*sys.argv[1:], "--headless", "--duration", "0.01"])
texts = [file for file in compiled if file in (None, "<string>")]
print(json.dumps({"code": code, "modules": sorted(sys.modules), "compiled": len(texts)}))
"""
# Python 3.13 compiles a text for each dataclass that has no method to write.
MORE = 0 if sys.version_info < (3, 13) else 130
COLLECTIONS = "import gc\nprint(gc.isenabled(), gc.get_stats()[0]['collections'])\n"

# What takes long to import, and is for what these do not have: sensors with pictures, wires, other people's code.
OF_OTHERS = {"importlib.metadata", "matplotlib", "PIL", "rosbags", "trimesh", "zenoh"}
OF_NONE = OF_OTHERS | {"drake_twin.cockpit", "drake_twin.film.film", "drake_twin.nodes", "drake_twin.services"}
OF_ROVERS = OF_NONE | {
    *("configparser", "importlib.resources", "pydrake.systems.sensors", "scipy", "xacro", "xml.dom.minidom"),
    *("drake_twin.from_launch", "drake_twin.ros2.launched", "drake_twin.ros2.ros_arguments"),
    *("drake_twin.description.meshes", "drake_twin.description.sdf_model", "drake_twin.description.world_file"),
    *("drake_twin.description.plugins.gz_drives", "drake_twin.description.setup_expressions"),
}


@pytest.fixture(scope="module")
def cache(tmp_path_factory):
    return tmp_path_factory.mktemp("cache")


def started(cache, *words):
    """What the second start with these words has imported and compiled."""
    for _ in range(2):
        result = subprocess.run(
            [sys.executable, "-c", LOOK, *words],
            capture_output=True,
            text=True,
            env={**os.environ, "XDG_CACHE_HOME": str(cache)},
        )
        found = json.loads(result.stdout.splitlines()[-1])
        assert found["code"] == 0, result.stderr
    return found


@pytest.mark.parametrize(
    ("words", "absent", "most_own", "most_compiled"),
    [
        (("--robots", "2"), OF_ROVERS, 280, 200),
        (
            ("diagrams/two_arms.yaml",),
            OF_NONE | {"pydrake.systems.sensors", "scipy", "xacro"},
            300,
            220,
        ),
        # Of Python 3.13's importlib.invalidate_caches, which Python launch files need.
        (("diagrams/rover_and_arm.launch.xml",), OF_NONE - {"importlib.metadata"}, 440, 250),
    ],
    ids=["rovers", "arms", "launch"],
)
def test_a_start_imports_and_compiles_only_what_it_uses(cache, words, absent, most_own, most_compiled):
    found = started(cache, *words)
    assert absent & {*found["modules"]} == set()
    assert sum(name.startswith("drake_twin") for name in found["modules"]) <= most_own
    assert found["compiled"] <= most_compiled + MORE


@pytest.mark.parametrize("program", [("drake_twin.run",), ("drake_twin", "run")])
def test_no_garbage_is_collected_while_modules_are_imported(tmp_path, program):
    (tmp_path / "look.py").write_text(COLLECTIONS)
    command = [sys.executable, "-P", "-m", *program, "--plugin", "look.py", "--show-kinds"]
    result = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    is_enabled, collections = result.stdout.splitlines()[0].split()
    assert is_enabled == "True"
    assert int(collections) < 30  # 17; with those of the imports 52

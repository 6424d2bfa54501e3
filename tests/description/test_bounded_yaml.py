"""Files of brackets end in a sentence, wherever YAML is read; PyYAML alone ends the process."""

import subprocess
import sys
from functools import partial
from pathlib import Path

import pytest
import yaml

from drake_twin.description.bounded_yaml import DEEPEST, compose_yaml, load_yaml
from drake_twin.description.yaml_document import YamlDocument
from drake_twin.errors import InputError

LEVELS = 40_000


@pytest.mark.parametrize("read", [load_yaml, compose_yaml])
@pytest.mark.parametrize("text", ["[" * LEVELS, "{a: " * LEVELS, "- " * LEVELS, "? " * LEVELS], ids=repr)
def test_what_nests_too_deep_is_refused(read, text):
    with pytest.raises(yaml.YAMLError, match=f"nest more than {DEEPEST} deep"):
        read(text)


def test_what_does_not_nest_too_deep_is_what_pyyaml_makes_of_it():
    text = "a: [1, 2.5, {b: null}]\nc: &x {d: yes}\ne: *x\n"
    assert load_yaml(text) == yaml.safe_load(text)
    deep = "[" * DEEPEST + "]" * DEEPEST
    assert load_yaml(deep) == yaml.safe_load(deep)


def test_a_document_says_where():
    with pytest.raises(InputError, match=rf"twin\.yaml:2: this is not valid YAML: .* more than {DEEPEST} deep"):
        YamlDocument("robots:\n  " + "[" * LEVELS, "twin.yaml")


@pytest.mark.parametrize("name", ["scenario.yaml", "thing.launch.yaml"])
def test_the_program_ends_with_a_sentence(tmp_path, name):
    (tmp_path / name).write_text("launch:\n  " + "[" * LEVELS)
    run = partial(subprocess.run, capture_output=True, text=True, cwd=Path(tmp_path))
    ended = run([sys.executable, "-m", "drake_twin.run", name, "--headless", "--duration", "0.1"])
    assert ended.returncode == 2
    assert "more than 100 deep" in ended.stderr
    assert "Traceback" not in ended.stderr

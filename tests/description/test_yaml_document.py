import datetime

import pytest

from drake_twin.description.yaml_document import YamlDocument
from drake_twin.errors import InputError


def data(text: str):
    return YamlDocument(text, "params.yaml").data


def refusal(text: str) -> str:
    with pytest.raises(InputError) as raised:
        YamlDocument(text, "params.yaml")
    return str(raised.value)


def test_values_are_plain_python_data():
    text = "a: 1\nb: 0.5\nc: text\nd: [true, null]\ne: {f: 2026-01-02}\n"
    assert data(text) == {"a": 1, "b": 0.5, "c": "text", "d": [True, None], "e": {"f": datetime.date(2026, 1, 2)}}


def test_an_empty_file_holds_nothing():
    assert data("# only a comment\n") is None


def test_every_value_knows_its_line():
    document = YamlDocument("arm:\n  joints:\n    - elbow\n    - wrist\n  rate: 50\n", "params.yaml")
    assert document.line(("arm", "joints", 1)) == 4
    assert document.line(("arm", "rate")) == 5


def test_a_value_that_is_not_there_has_the_line_of_what_would_hold_it():
    document = YamlDocument("other: 1\narm:\n  rate: 50\n", "params.yaml")
    assert document.line(("arm", "gains", "p")) == 3  # the mapping below "arm:" starts there


def test_an_error_points_at_file_line_and_path_and_lists_what_is_valid():
    document = YamlDocument("arm:\n  mode: fats\n", "params.yaml")
    error = document.error(("arm", "mode"), "'fats' is no mode", valid=["fast", "slow"], value="fats")
    assert str(error) == "params.yaml:2: arm.mode: 'fats' is no mode. Did you mean 'fast'? Valid: fast, slow."


def test_an_error_below_a_key_of_several_lines_is_one_paragraph():
    document = YamlDocument("a: 1", "robot.yaml")
    assert "\n" not in str(document.error(("a", "b\n\n  ", 2), "it is wrong"))


def test_broken_yaml_gives_the_line():
    assert refusal("a: 1\nb: [1, 2\nc: 3\n").startswith("params.yaml:3: this is not valid YAML: ")


def test_a_tab_as_indentation_gives_the_line():
    assert refusal("a:\n\tb: 1\n").startswith("params.yaml:2: this is not valid YAML: ")


def test_two_documents_in_one_file_are_refused():
    assert refusal("a: 1\n---\nb: 2\n").startswith("params.yaml:2: this is not valid YAML: ")


def test_a_key_that_stands_twice_in_one_mapping_is_refused():
    assert refusal("a:\n  b: 1\n  c: 2\n  b: 3\n") == "params.yaml:4: 'b' occurs twice."


def test_a_key_may_stand_in_two_mappings():
    assert data("a: {c: 1}\nb: {c: 2}\n") == {"a": {"c": 1}, "b": {"c": 2}}


def test_a_key_that_is_a_list_is_refused():
    assert refusal("a: 1\n? [b, c]\n: 2\n") == "params.yaml:2: a mapping's key must be text."


@pytest.mark.parametrize("value", ["!!int ''", "!!float abc", "!!bool abc", "!!timestamp abc", "2026-13-45"])
def test_a_value_that_its_type_does_not_allow_gives_the_line(value):
    text = refusal(f"a: 1\nb: {value}\n")
    assert text.startswith("params.yaml:2: ")
    assert text.endswith(" is not a value.")


def test_no_tag_makes_a_python_object():
    assert data("a: !!python/object/apply:os.getcwd []\n") == {"a": []}
    assert "is not a value" in refusal("a: !!python/name:os.getcwd\n")


def test_an_alias_stands_for_its_anchors_value():
    assert data("a: &joints [elbow]\nb: *joints\n") == {"a": ["elbow"], "b": ["elbow"]}


def test_a_merge_key_gives_values_that_the_mapping_may_replace():
    assert data("base: &base {p: 1, d: 2}\narm: {<<: *base, d: 3}\n")["arm"] == {"p": 1, "d": 3}


def test_the_first_of_several_merged_mappings_counts():
    assert data("a: &a {p: 1}\nb: &b {p: 2, d: 2}\narm: {<<: [*a, *b]}\n")["arm"] == {"p": 1, "d": 2}


def test_a_mapping_with_a_replaced_merged_value_may_be_aliased():
    text = "a: &a {p: 1}\nb: &b {<<: *a, p: 2}\nc: *b\nd: {<<: *b}\n"
    assert data(text) == {"a": {"p": 1}, "b": {"p": 2}, "c": {"p": 2}, "d": {"p": 2}}


def test_merging_a_value_that_is_no_mapping_is_refused():
    assert refusal("a: 1\nb:\n  <<: 5\n") == "params.yaml:3: << takes a mapping or a list of them."


def test_a_mapping_that_merges_itself_is_read_once():
    assert data("a: &a {<<: *a, b: 1}\n") == {"a": {"b": 1}}


def test_an_alias_bomb_is_refused():
    lists = "".join(f"a{i + 1}: &a{i + 1} [{', '.join([f'*a{i}'] * 10)}]\n" for i in range(9))
    assert refusal("a0: &a0 [x]\n" + lists) == "params.yaml: the file holds more than 200000 values."


def test_a_bomb_of_merges_is_as_small_as_what_it_merges():
    bases = ", ".join(f"&a{i + 1} {{<<: [{', '.join([f'*a{i}'] * 10)}]}}" for i in range(20))
    assert data(f"a: &a0 {{k: 1}}\nb: {{<<: [{bases}]}}\n")["b"] == {"k": 1}


@pytest.mark.parametrize("text", ["a: &a [*a]\n", "a: &a {b: *a}\n"])
def test_an_alias_inside_its_own_anchor_is_refused(text):
    assert refusal(text) == "params.yaml:1: the values nest more than 100 deep."


@pytest.mark.parametrize("text", ["[" * 5000 + "]" * 5000, "{<<: " * 5000 + "{}" + "}" * 5000])
def test_values_that_nest_too_deep_are_refused(text):
    assert "more than 100 deep" in refusal(text)

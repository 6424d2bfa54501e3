"""Environment variables that are appended to, in XML and in Python."""

import pytest
from launch_files import launch_python, launch_xml


@pytest.mark.parametrize(
    ("more", "expected"),
    [
        ("", "old:new"),
        ('prepend="true"', "new:old"),
        ('prepend="false"', "old:new"),
        ('separator=","', "old,new"),
        ('prepend="$(var first)" separator=";"', "new;old"),
    ],
)
def test_a_value_is_appended_or_prepended(tmp_path, more, expected):
    launched = launch_xml(
        tmp_path,
        f'<set_env name="TWIN_LIST" value="old"/><append_env name="TWIN_LIST" value="new" {more}/>'
        '<log message="$(env TWIN_LIST)"/>',
        first="true",
    )
    assert launched.log == (expected,)
    assert launched.refused_by_ros == ()


def test_a_variable_that_is_not_set_or_empty_is_the_value(tmp_path):
    appended = '<append_env name="TWIN_LIST" value="new"/><log message="$(env TWIN_LIST)"/>'
    assert launch_xml(tmp_path, appended).log == ("new",)
    assert launch_xml(tmp_path, f'<set_env name="TWIN_LIST" value=""/>{appended}').log == ("new",)


def test_in_python_prepend_may_be_text(tmp_path):
    entities = "SetEnvironmentVariable('TWIN_LIST', 'old'), AppendEnvironmentVariable('TWIN_LIST', 'new', prepend={}),"
    entities += "LogInfo(msg=EnvironmentVariable('TWIN_LIST'))"
    for prepend, expected in (("True", "new:old"), ("'true'", "new:old"), ("'false'", "old:new")):
        assert launch_python(tmp_path, entities.format(prepend)).log == (expected,)

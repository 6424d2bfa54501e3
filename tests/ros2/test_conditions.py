import pytest
from launch_files import launch_python

from drake_twin.errors import InputError


@pytest.mark.parametrize(
    ("condition", "holds"),
    [
        ("IfCondition('true')", True),
        ("IfCondition(' True ')", True),
        ("IfCondition('1')", True),
        ("IfCondition('0')", False),
        ("IfCondition(LaunchConfiguration('flag'))", False),
        ("IfCondition(PythonExpression(['not ', LaunchConfiguration('flag')]))", True),
        ("UnlessCondition(LaunchConfiguration('flag'))", True),
        ("UnlessCondition('1')", False),
        ("LaunchConfigurationEquals('flag', 'False')", True),
        ("LaunchConfigurationEquals('none', None)", True),
        ("LaunchConfigurationNotEquals('flag', 'False')", False),
        ("Condition(predicate=lambda context: True)", True),
    ],
)
def test_an_action_is_executed_if_its_condition_holds(tmp_path, condition, holds):
    launched = launch_python(tmp_path, f"LogInfo(msg='executed', condition={condition})", flag="False")
    assert launched.log == (("executed",) if holds else ())


@pytest.mark.parametrize("text", ["yes", "", "truee"])
def test_a_condition_that_is_neither_true_nor_false_is_refused(tmp_path, text):
    with pytest.raises(InputError, match=rf"test.launch.py:17: the condition is '{text}', which is neither true nor"):
        launch_python(tmp_path, f"LogInfo(msg='x', condition=IfCondition('{text}'))")


def test_something_that_is_no_condition_is_refused(tmp_path):
    with pytest.raises(InputError, match="TypeError: condition= takes a condition such as IfCondition"):
        launch_python(tmp_path, "LogInfo(msg='x', condition='true')")

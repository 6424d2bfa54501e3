import pytest
from launch_files import launch_xml, write, write_package

from drake_twin.errors import InputError


def value(folder, text, **arguments):
    return launch_xml(folder, f'<log message="{text}"/>', **arguments).log[-1]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("plain", "plain"),
        ("$(var n)", "2"),
        ("a$(var n)b$(var n)", "a2b2"),
        ("$(var none default)", "default"),
        ("$(env A_VARIABLE)", "set"),
        ("$(env NO_VARIABLE 'two words')", "two words"),
        ("$(optenv NO_VARIABLE)", ""),
        ("$(optenv NO_VARIABLE two words)", "two words"),
        ("$(eval '1 + $(var n)')", "3"),
        ("$(eval 1 + $(var n))", "3"),
        ("$(eval &quot;'$(var n)' == '2'&quot;)", "True"),
        ("$(eval '\\'$(var n)\\' == \\'2\\'')", "True"),
        ("$(eval 'abs(-3)')", "3"),
        ("$(eval abs(-3))", "3"),
        ("$(eval 'os.sep' os)", "/"),
        ("$(command 'echo $(var n)')", "2\n"),
        ("$(find-pkg-share none)/x", "/package-not-found/none/x"),
        ("$(find none)", "/package-not-found/none"),
        ("$(find-exec ros2)", "ros2"),
        ("$(exec-in-pkg run none)", "/package-not-found/none/lib/none/run"),
        ("$(not true)", "false"),
        ("$(and true $(not false))", "true"),
        ("$(or false 0)", "false"),
        ("$(all true true)", "true"),
        ("$(any false true)", "true"),
        ("$(equals $(var n) 2.0)", "true"),
        ("$(not-equals a b)", "true"),
        ("$(if true yes no)", "yes"),
        ("$(anon x)", "x_1"),
        ("$(var $(var name))", "2"),
        ("cost: $5 (about)", "cost: $5 (about)"),
        ("\\$(var n)", "$(var n)"),
    ],
)
def test_what_text_with_substitutions_gives(tmp_path, monkeypatch, text, expected):
    monkeypatch.setenv("A_VARIABLE", "set")
    monkeypatch.delenv("NO_VARIABLE", raising=False)
    assert value(tmp_path, text, n="2", name="n") == expected


def test_the_launch_files_own_path(tmp_path):
    assert value(tmp_path, "$(dirname)|$(filename)") == f"{tmp_path}|{tmp_path}/test.launch.xml"


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("$(vra n)", r"test.launch.xml:2: <log>: unknown substitution \$\(vra …\). Did you mean 'var'"),
        ("$(var n", "is not closed with a parenthesis"),
        ("$(var 'n", "is not closed with a parenthesis"),
        ("$(equals a)", r"\$\(equals …\) takes 2 arguments, and there are 1"),
        ("$(var none)", "test.launch.xml:2: launch configuration 'none' does not exist"),
    ],
)
def test_a_wrong_substitution_is_refused_with_its_line(tmp_path, text, reason):
    with pytest.raises(InputError, match=reason):
        value(tmp_path, text)


def test_xacro_in_a_command(tmp_path):
    package = write_package(tmp_path, "robots")
    write(
        package / "r.xacro",
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="n" default=""/>'
        '<link name="$(arg n)"/></robot>',
    )
    text = value(tmp_path, "$(command 'xacro $(find-pkg-share robots)/r.xacro n:=$(var n)')", n="base")
    assert '<link name="base"/>' in text

"""Which findings a run tells, and in what order."""

from drake_twin.findings import Finding, Kind, most_telling


def findings(count, kind=Kind.IGNORED, what="<thing {}> in <link>"):
    return [Finding(kind, what.format(number), robot="r") for number in range(count)]


def test_a_few_findings_are_all_told():
    assert most_telling([]) == []
    assert most_telling(findings(5)) == [f"ignored: r: <thing {number}> in <link>" for number in range(5)]


def test_of_many_the_last_line_tells_how_many_more_there_are():
    lines = most_telling([*findings(4), *findings(3, Kind.WARNING, "odd {}")])
    assert len(lines) == 5
    assert lines[-1] == "and 3 more findings (3 warning): --findings prints them all"


def test_what_does_not_start_comes_first_and_looks_come_last():
    looks = findings(4, what="<ambient{}> in <material>")
    lines = most_telling(
        [*looks, *findings(2, Kind.WARNING, "odd {}"), *findings(1, Kind.NOT_STARTED, "controller {}")]
    )
    assert lines[:4] == [
        "not started: r: controller 0",
        "warning: r: odd 0",
        "warning: r: odd 1",
        "ignored: r: <ambient0> in <material>",
    ]


def test_a_window_comes_last_and_looks_are_those_of_files():
    started = [Finding(Kind.NOT_STARTED, "controller <light> of r")]
    lines = most_telling([*findings(6, Kind.WINDOW, "rviz {}"), *started, *findings(1, Kind.FAILED, "controller {}")])
    assert lines[:2] == ["failed: r: controller 0", "not started: controller <light> of r"]


def test_the_same_of_several_robots_is_one_line():
    each = [Finding(Kind.IGNORED, f"<thing {number}>", robot=robot) for number in range(5) for robot in ("a", "b")]
    assert most_telling(each)[0] == "ignored: a, b: <thing 0>"
    assert len(most_telling(each)) == 5

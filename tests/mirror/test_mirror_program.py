"""``python -m drake_twin.mirror``: exit codes, reports, profiles, and input that cannot be used."""

import re
import signal
from dataclasses import replace

import pytest
from real_robot import JOINT_STATES, Run, real
from recorded import write_bag

from drake_twin.messages.interface_types import make
from drake_twin.mirror import heard
from drake_twin.mirror.__main__ import main
from drake_twin.mirror.profile import Profile
from drake_twin.scenario.scenario_file import scenario_to_yaml

FAULTY = Run(seed=2, duration=9.0, fault="encoder_frozen", at=6.0)


@pytest.fixture(scope="module")
def bags(tmp_path_factory):
    """Bags of an arm, a healthy one and a faulty one, what was learned of it, and its scenario."""
    folder = tmp_path_factory.mktemp("bags")
    robot = real("arm")
    write_bag(folder / "healthy", robot.run(Run(seed=1, duration=45.0)))
    write_bag(folder / "faulty", robot.run(FAULTY))
    (folder / "arm.yaml").write_text(scenario_to_yaml(robot.scenario))
    robot.close()
    learn = ["--bag", str(folder / "healthy"), "--learn", str(folder / "healthy.json")]
    assert main([str(folder / "arm.yaml"), *learn]) == 0
    return folder


def mirror(bags, bag, *words):
    return main([str(bags / "arm.yaml"), "--bag", str(bags / bag), *map(str, words)])


def test_a_healthy_bag_ends_with_0_and_a_faulty_one_with_3_and_the_report(bags, tmp_path, capsys):
    profile = bags / "healthy.json"
    assert mirror(bags, "healthy", "--profile", profile, "--report", tmp_path / "healthy.html") == 0
    assert ": no alarm" in capsys.readouterr().out
    assert "The robot moved as its twin did: no alarm." in (tmp_path / "healthy.html").read_text()
    assert mirror(bags, "faulty", "--profile", profile, "--report", tmp_path / "faulty.html") == 3
    said = capsys.readouterr().out
    assert re.search(
        r"alarm: \d\.\d+ s .*: robot_1: the encoder of joint_\d reports the same number .*encoder_frozen", said
    )
    report = (tmp_path / "faulty.html").read_text()
    assert "encoder_frozen" in report
    assert "<script" not in report
    assert 'name="viewport"' in report


def test_the_same_bag_gives_the_same_report(bags, tmp_path):
    for name in ("one.html", "two.html"):
        assert mirror(bags, "faulty", "--profile", bags / "healthy.json", "--report", tmp_path / name) == 3
    assert (tmp_path / "one.html").read_bytes() == (tmp_path / "two.html").read_bytes()


def test_a_report_that_cannot_be_written_leaves_the_one_before(bags, tmp_path, capsys):
    assert mirror(bags, "faulty", "--report", tmp_path / "no" / "r.html") == 2
    assert "the folder does not exist" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ((), "what is to be followed? --bag FOLDER names a bag of the robot, --ros the running one"),
        (("--bag", "x", "--ros"), "what is to be followed?"),
        (("--bag", "x", "--duration", "3"), "--duration is for a running robot"),
        (
            ("--bag", "x", "--learn", "a.json", "--profile", "b.json"),
            "--learn writes a profile and --profile reads one",
        ),
        (("--bag", "x", "--report", "r.pdf"), "--report r.pdf: it must end in .html"),
        (("--bag", "x", "--false-alarm-every", "0"), "--false-alarm-every 0: it must be above 0"),
        (("--bag", "x", "--map", "a"), "--map a: it must read ROBOT_TOPIC=TWIN_TOPIC"),
        (("--bag", "no_such_bag"), "the bag does not exist"),
        (("--bag", "x", "--profile", "no.json"), "cannot read a mirror's profile"),
    ],
)
def test_what_cannot_be_is_refused_in_a_paragraph(capsys, words, said):
    assert main(["--robots", "1", *words]) == 2
    error = capsys.readouterr().err
    assert said in error
    assert "Traceback" not in error


def test_a_profile_that_is_another_file_or_damaged_is_refused(bags, tmp_path, capsys):
    (tmp_path / "a.json").write_text('{"format": "drake_twin saved state"}')
    assert mirror(bags, "faulty", "--profile", tmp_path / "a.json") == 2
    text = (bags / "healthy.json").read_text()
    (tmp_path / "b.json").write_text(text.replace('"topics"', '"topic"'))
    assert mirror(bags, "faulty", "--profile", tmp_path / "b.json") == 2
    said = capsys.readouterr().err
    assert "this is not a mirror's profile" in said
    assert "the mirror's profile is damaged" in said
    assert Profile.read(bags / "healthy.json").duration > 30


def test_a_profile_of_another_robot_is_refused(bags, tmp_path, capsys):
    text = (bags / "healthy.json").read_text()
    (tmp_path / "c.json").write_text(text.replace("/robot_1/joint_states", "/robot_9/joint_states"))
    assert mirror(bags, "faulty", "--profile", tmp_path / "c.json") == 2
    assert "the profile is of other topics (/robot_9/joint_states)" in capsys.readouterr().err


def test_a_bag_of_another_robot_is_refused_with_what_it_has(bags, capsys):
    assert main(["--robots", "2", "--bag", str(bags / "faulty")]) == 2
    error = capsys.readouterr().err
    assert "measures a robot of the twin" in error or "joint_1" in error


def changed(robot, run, change):
    """A run's messages, of which the joint states are changed, or left out where it returns None."""
    for item in robot.run(run):
        fields = item.message if item.topic != JOINT_STATES else change(item)
        if fields is not None:
            yield replace(item, message=fields)


def states(message, **fields):
    names = ("name", "position", "velocity", "effort")
    same = {name: getattr(message, name) for name in names}
    stamp = {"sec": message.header.stamp.sec, "nanosec": message.header.stamp.nanosec}
    return make("sensor_msgs/msg/JointState", {"header": {"stamp": stamp}, **same, **fields})


def test_degrees_are_named(bags, tmp_path, capsys):
    robot = real("arm")
    run = Run(seed=3, duration=4.0, elsewhere=True)
    messages = changed(robot, run, lambda item: states(item.message, position=57.2958 * item.message.position))
    write_bag(tmp_path / "degrees", messages)
    robot.close()
    assert main([str(bags / "arm.yaml"), "--bag", str(tmp_path / "degrees")]) == 2
    assert "in degrees" in capsys.readouterr().err


def test_joints_that_are_not_measured_follow_from_the_model_and_that_is_said(bags, tmp_path, capsys):
    robot = real("arm")
    cut = {name: slice(2) for name in ("name", "position", "velocity", "effort")}
    messages = changed(
        robot,
        Run(seed=3, duration=8.0),
        lambda item: states(item.message, **{name: getattr(item.message, name)[part] for name, part in cut.items()}),
    )
    write_bag(tmp_path / "few", messages)
    robot.close()
    assert main([str(bags / "arm.yaml"), "--bag", str(tmp_path / "few")]) == 0
    assert "joint_3, joint_4, joint_5 are not measured" in capsys.readouterr().err


def test_half_a_bag_is_looked_at_as_far_as_it_goes_or_refused(bags, tmp_path, capsys):
    whole = bags / "healthy"
    half = tmp_path / "half"
    half.mkdir()
    for file in whole.iterdir():
        data = file.read_bytes()
        (half / file.name).write_bytes(data if file.suffix == ".yaml" else data[: len(data) // 2])
    assert main([str(bags / "arm.yaml"), "--bag", str(half)]) in (0, 2, 3)
    error = capsys.readouterr().err
    assert "Traceback" not in error
    assert str(half) in error


def test_a_signal_ends_it_with_what_was_seen_so_far(bags, tmp_path, monkeypatch, capsys):
    real_messages = heard.messages_of

    def messages_of(bag, topics):
        for count, message in enumerate(real_messages(bag, topics)):
            if count == 300:
                signal.raise_signal(signal.SIGINT)
            yield message

    monkeypatch.setattr(heard, "messages_of", messages_of)
    assert mirror(bags, "faulty", "--profile", bags / "healthy.json", "--report", tmp_path / "r.html") == 0
    assert re.search(r"stopped at \d\.\d s of the bag's \d\.\d s", capsys.readouterr().err)
    assert "no alarm" in (tmp_path / "r.html").read_text()


def test_time_that_runs_back_and_ten_kilohertz_do_not_end_it(bags, tmp_path, capsys):
    robot = real("arm")
    fast = robot.run(Run(seed=5, duration=3.0, joint_rate=2000.0))
    robot.close()
    back = [replace(item, message=states(item.message)) if item.topic == JOINT_STATES else item for item in fast]
    for item in back[len(back) // 2 :]:
        if item.topic == JOINT_STATES:
            item.message.header.stamp.sec -= 1000
    write_bag(tmp_path / "back", back)
    assert main([str(bags / "arm.yaml"), "--bag", str(tmp_path / "back")]) == 0
    assert "the robot's clock was set" in capsys.readouterr().err

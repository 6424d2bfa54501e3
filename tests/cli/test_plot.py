import re
import signal
import subprocess
import sys
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from PIL import Image

from drake_twin.cli.history import RobotHistory, RunHistory
from drake_twin.cli.plot import write_plot
from drake_twin.run import main


def robot(joints, unit="rad", count=50):
    times = np.linspace(0, 1, count)
    moves = np.outer(times, np.arange(len(joints)))  # the later in the list, the more it moves
    return RobotHistory(tuple(joints), (unit,) * len(joints), times, moves, moves, moves)


def run_of(robots):
    return RunHistory(robots, np.linspace(0, 1, 5), np.array([1.0, 2.0, 1.5, 1.0]))


def words(file):
    """The text in an SVG file."""
    return ["".join(node.itertext()).strip() for node in ET.parse(file).iter("{http://www.w3.org/2000/svg}text")]


def plotted(tmp_path, robots):
    write_plot(run_of(robots), tmp_path / "run.svg")
    return words(tmp_path / "run.svg")


def test_a_figure_says_which_robots_joints_and_units(tmp_path):
    text = plotted(tmp_path, {"rover": robot(["rover_left_wheel_joint", "tilt"]), "lift": robot(["up"], "m")})
    assert {"rover", "left_wheel", "tilt", "lift", "up"} <= set(text)
    assert {"position (rad)", "velocity (rad/s)", "effort (N·m)"} <= set(text)
    assert {"position (m)", "velocity (m/s)", "effort (N)"} <= set(text)
    assert {"simulated time (s)", "real-time factor"} <= set(text)


def test_of_many_joints_the_ten_that_move_most_are_named(tmp_path):
    text = plotted(tmp_path, {"hand": robot([f"finger_{number}" for number in range(30)])})
    assert [word for word in text if word.startswith("finger")] == [f"finger_{number}" for number in range(20, 30)]
    assert "20 more, which move less" in text


def test_many_robots_stay_as_wide_as_a_few_and_go_on_below(tmp_path):
    few, many = ({f"robot_{number}": robot(["a", "b"]) for number in range(count)} for count in (6, 13))
    write_plot(run_of(few), tmp_path / "few.png")
    write_plot(run_of(many), tmp_path / "many.png")
    with Image.open(tmp_path / "few.png") as first, Image.open(tmp_path / "many.png") as second:
        assert first.width == second.width
        assert second.height > 2 * first.height


def test_a_robot_that_stands_still_is_a_line_and_not_its_last_bits(tmp_path):
    still = robot(["a"])
    noise = 1e-17 * np.sin(np.arange(50.0))[:, None]
    text = plotted(tmp_path, {"r": RobotHistory(("a",), ("rad",), still.times, noise, noise, noise)})
    assert not any("e−" in word or "e-" in word for word in text)


@pytest.mark.parametrize("robots", [{}, {"block": robot([])}])
def test_without_joints_the_real_time_factor_is_left(tmp_path, robots):
    text = plotted(tmp_path, robots)
    assert "real-time factor" in text
    assert "position (rad)" not in text


# --- the program


@pytest.mark.parametrize(
    ("suffix", "start"), [(".png", b"\x89PNG"), (".svg", b"<?xml"), (".pdf", b"%PDF"), (".PNG", b"\x89PNG")]
)
def test_the_program_draws_a_run_in_the_format_of_the_name(tmp_path, suffix, start):
    file = tmp_path / f"run{suffix}"
    assert main(["--headless", "--duration", "0.1", "--plot", str(file)]) == 0
    assert file.read_bytes().startswith(start)
    if start == b"\x89PNG":
        with Image.open(file) as image:
            image.verify()


def test_a_run_with_a_plot_ends_in_the_same_state(tmp_path, capsys):
    states = []
    for more in ([], ["--plot", str(tmp_path / "run.svg")]):
        assert main(["--headless", "--duration", "0.3", *more]) == 0
        states.append(capsys.readouterr().out.rpartition("state ")[2])
    assert states[0] == states[1]


def test_ctrl_c_ends_a_run_with_its_plot(tmp_path):
    file = tmp_path / "run.svg"
    command = [sys.executable, "-m", "drake_twin.run", "--headless", "--echo", "/clock", "--plot", str(file)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    with process:
        for _ in range(20):
            assert process.stdout.readline()  # it runs
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        assert (process.returncode, errors) == (0, "")
    assert "robot_1" in words(file)


def test_a_name_that_is_no_format_is_refused(tmp_path, capsys):
    assert main(["--headless", "--duration", "0.1", "--plot", str(tmp_path / "run.gif")]) == 2
    assert "Valid: .png, .svg, .pdf." in capsys.readouterr().err


def test_a_folder_that_is_not_there_is_refused_before_the_run(tmp_path, capsys):
    assert main(["--headless", "--duration", "0.1", "--plot", str(tmp_path / "no" / "run.png")]) == 2
    output = capsys.readouterr()
    assert "no file can be written there" in output.err
    assert "simulated" not in output.out


def test_without_matplotlib_the_program_says_how_to_get_it_before_the_run(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("drake_twin.cli.plot.find_spec", lambda _: None)
    assert main(["--headless", "--duration", "0.1", "--plot", str(tmp_path / "run.png")]) == 2
    output = capsys.readouterr()
    assert "python -m pip install 'matplotlib>=" in output.err
    assert len(output.err.splitlines()) == 1
    assert "simulated" not in output.out


def test_matplotlib_is_imported_only_for_a_plot():
    program = "import sys; from drake_twin.run import main; main(sys.argv[1:]); assert 'matplotlib' not in sys.modules"
    subprocess.run([sys.executable, "-c", program, "--headless", "--duration", "0.01"], check=True)


def test_names_stand_between_a_robots_title_and_its_first_axes_and_all_within_the_picture(tmp_path):
    write_plot(run_of({"rover": robot(["tilt", "pan"])}), tmp_path / "run.svg")
    root = ET.parse(tmp_path / "run.svg").getroot()
    _, _, width, height = map(float, root.get("viewBox").split())
    places = {}
    for node in root.iter("{http://www.w3.org/2000/svg}text"):
        moved = re.match(r"translate\(([-\d.]+) ([-\d.]+)\)", node.get("transform", ""))
        x, y = map(float, moved.groups() if moved else (node.get("x"), node.get("y")))
        assert 0 <= x <= width
        assert 0 <= y <= height
        places["".join(node.itertext()).strip()] = y
    assert words(tmp_path / "run.svg").count("simulated time (s)") == 2  # of the robot and of the real-time factor
    assert places["tilt"] == places["pan"]
    assert places["rover"] < places["tilt"] < places["position (rad)"]
    assert places["position (rad)"] < places["velocity (rad/s)"] < places["effort (N·m)"] < places["simulated time (s)"]

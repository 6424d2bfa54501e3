"""Which commands of launch files do their work and end: what each program's own help says."""

import pytest

from drake_twin.ros2.ending_commands import command_ends, node_ends, shell_words


@pytest.mark.parametrize(
    ("command", "ends"),
    [
        ("ros2 control load_controller --set-state active jsb", True),
        ("ros2 topic pub --once /x std_msgs/msg/Empty", True),
        ("ros2 topic pub -t 3 /x std_msgs/msg/Empty", True),
        ("ros2 topic pub -r 10 /x std_msgs/msg/Empty", False),
        ("ros2 topic echo /x", False),
        ("ros2 service call /x std_srvs/srv/Empty", True),
        ("ros2 param set /n p 1", True),
        ("ros2 run gazebo_ros spawn_entity.py -entity r", True),
        ("ros2 run rviz2 rviz2", False),
        ("ros2 run rviz2", False),
        ("ros2 launch p x.launch.py", False),
        ("ros2 bag record -a", False),
        ("ros2", False),
        ("gz sim -r empty.sdf", False),
        ("gz service -s /world/empty/create", True),
        ("gz topic -e -t /clock", False),
        ("gz topic -t /x -m gz.msgs.Empty -p ''", True),
        ("ign model --list", True),
        ("gzserver x.world", False),
        ("bash -c 'sleep 5; echo done'", True),
        ("bash -c 'echo start && rviz2'", False),
        ("bash -c ''", False),
        ("sh /opt/setup.sh", True),
        ("bash -x /opt/init.sh", True),
        ("bash /opt/spawn_robot", True),
        ("bash /opt/spawn/viewer", False),
        ("bash", False),
        ("rviz2", False),
        ("/usr/bin/echo hello", True),
        ("sleep 3", True),
    ],
)
def test_which_commands_do_their_work_and_end(command, ends):
    assert command_ends(shell_words(command)) is ends


@pytest.mark.parametrize(
    ("executable", "ends"),
    [
        *((name, True) for name in ("create", "spawner", "spawner.py", "unspawner", "spawn_entity.py", "wait_for_it")),
        *((name, True) for name in ("robot_spawner", "spawn_box.py", "delete_entity", "load_controllers", "init.sh")),
        *((name, False) for name in ("creator", "rviz2", "respawned", "offset_node", "ekf_node", "spawning_grounds")),
    ],
)
def test_which_executables_do_their_work_and_end(executable, ends):
    assert node_ends(executable) is ends


def test_a_line_with_an_unbalanced_quote_is_split_at_its_spaces():
    assert shell_words("echo 'a b' c") == ["echo", "a b", "c"]
    assert shell_words("echo it's c") == ["echo", "it's", "c"]

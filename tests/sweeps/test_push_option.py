"""The option ``--push`` of a sweep."""

import pytest
from sweep_files import hinge_scenario, write_sweep

from drake_twin import Twin, run, sweep
from drake_twin.scenario import Push
from drake_twin.scenario.scenario_file import ScenarioFile
from drake_twin.sweeps.push_option import read_push, with_pushes
from drake_twin.sweeps.results import read_table


@pytest.mark.parametrize(
    ("text", "push"),
    [
        ("robot_1=20N@1s", Push("robot_1", 1.0, strength=20.0, duration=0.1)),
        ("robot_1.base_link=20N@1.5s+0.2s", Push("robot_1::base_link", 1.5, strength=20.0, duration=0.2)),
        ("robot_1=20,0,-5.5N@1s", Push("robot_1", 1.0, force=(20.0, 0.0, -5.5))),
        ("robot_1=1e2,0,5 N @ .5s + 2s", Push("robot_1", 0.5, force=(100.0, 0.0, 5.0), duration=2.0)),
    ],
)
def test_a_push_reads_as_it_is_written(text, push):
    assert read_push(text) == push


def test_pushes_add_to_those_of_the_scenario(tmp_path):
    scenario = with_pushes(hinge_scenario(tmp_path), ["hinge=2N@0.1s"], 1.0)
    both = with_pushes(scenario, ["hinge.arm=1,0,0N@0.2s"], 1.0)
    assert both.pushes == (Push("hinge", 0.1, strength=2.0), Push("hinge::arm", 0.2, force=(1.0, 0.0, 0.0)))


def test_the_pushes_belong_to_the_table_and_rows_run_again_to_the_same_bits(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(write_sweep(tmp_path))
    urdf = tmp_path / "hinge.urdf"
    urdf.write_text(urdf.read_text().replace("<inertial>", '<inertial><origin xyz="0.5 0.1 0"/>'))
    ids, hashes = [], []
    for pushes in ([], ["--push", "hinge.arm=0,20,0N@0.01s+0.02s"], ["--push", "hinge.arm=30N@0.01s"]):
        given = ["hinge.yaml", "--vary", "hinge.arm.mass=1,2", "--seeds", "2", "--duration", "0.05", *pushes]
        assert sweep.main([*given, "--out", "t.csv", "--workers", "1", "--force"]) == 0
        definition, rows = read_table(tmp_path / "t.csv")
        ids += [row["id"] for row in rows]
        hashes.append([row["state_sha256"] for row in rows])
        assert len(ScenarioFile(definition["scenario"], "x").scenario.pushes) == (len(pushes) > 0)
    assert len(set(ids)) == 12
    assert [len(set(each)) for each in hashes] == [2, 2, 4]  # only a drawn direction depends on the seed
    assert not set(hashes[0]) & {*hashes[1], *hashes[2]}
    capsys.readouterr()
    for number in (0, 3):
        assert run.main(["--headless", "--episode", f"t.csv:{number}"]) == 0
        assert f"row {number}: the same state as in the table, to the last bit" in capsys.readouterr().err


def test_a_pushed_joint_turns_as_the_closed_form_says(tmp_path):
    from drake_twin.scenario import Robot, Scenario

    (tmp_path / "h.urdf").write_text(
        '<robot name="h"><link name="world"/><link name="arm"><inertial><origin xyz="0.5 0 0"/><mass value="2"/>'
        '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="j" type="prismatic"><parent link="world"/><child link="arm"/><axis xyz="0 1 0"/>'
        '<limit effort="0" velocity="9" lower="-9" upper="9"/></joint></robot>'
    )
    scenario = Scenario((Robot("h", str(tmp_path / "h.urdf")),))
    twin = Twin(with_pushes(scenario, ["h.arm=5,8,1N@0.1s+0.25s"], 1.0))
    twin.advance_to(0.5)
    assert twin.robot_state("h").velocities[0] == pytest.approx(8 * 0.25 / 2, rel=1e-6)


@pytest.mark.parametrize(
    ("push", "message"),
    [
        ("hinge", "it must read ROBOT[.LINK]=FORCE@TIME[+DURATION], for example robot_1=20N@1s"),
        ("hinge=20@1s", "it must read ROBOT[.LINK]"),
        ("hinge=20,0N@1s", "it must read ROBOT[.LINK]"),
        ("hinge=nanN@1s", "it must read ROBOT[.LINK]"),
        ("hinge=20N@1", "it must read ROBOT[.LINK]"),
        ("hinge=1e999N@0s", "inf is not a finite number"),
        ("hinge=0N@0s", "0 N is not above zero"),
        ("hinge=20N@-1s", "-1 s is not a time from zero"),
        ("hinge=20N@0s+-1s", "-1 s is not a duration"),
        ("hinge=20N@1s", "it begins at 1 s, but an episode ends at 0.5 s"),
        ("hingee=20N@0s", "Entity [hingee] does not exist. Did you mean 'hinge'"),
        ("hinge.amr=20N@0s", "robot 'hinge' has no link 'amr'. Did you mean 'arm'"),
    ],
)
def test_a_push_that_cannot_be_used_is_refused_before_anything_runs(tmp_path, monkeypatch, capsys, push, message):
    monkeypatch.chdir(write_sweep(tmp_path))
    given = ["hinge.yaml", "--duration", "0.5", "--out", "t.csv", "--workers", "1"]
    assert sweep.main([*given, "--push", push]) == 2
    err = capsys.readouterr().err
    assert message in err
    assert err.startswith("error: ")
    assert err.count("\n") == 1
    assert not (tmp_path / "t.csv").exists()

"""The page of gz-sim's systems says what the registries say."""

from pathlib import Path

import drake_twin
from drake_twin.description.docs import systems, systems_page
from drake_twin.description.gazebo_drive import GAZEBO_PLUGINS
from drake_twin.description.gazebo_plugins import DONE_HERE
from drake_twin.description.plugin_names import misspelt_plugin
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.world_plugins import WORLD_PLUGINS

# Kinds of older releases, and other spellings.
OLDER = {
    *("force-torque-system", "nav-sat-system", "multicopter-velocity-control-system"),
    "lighter-than-air-dynamics-system",
    *("gazebo_ros_init", "gazebo_ros_factory", "gazebo_ros_clock", "gazebo_ros_state"),
}


def test_the_page_is_up_to_date():
    page = Path(drake_twin.__file__).parent / "docs" / "gazebo_systems.md"
    assert page.read_text(encoding="utf-8") == systems_page(Path(__file__).parents[1])


def test_what_runs_is_a_system_of_gz_sim():
    """A spelling that no file has would never be found."""
    known = {kind for kind in (*GAZEBO_PLUGINS, *WORLD_PLUGINS, *DONE_HERE) if kind.endswith("-system")}
    assert known - set(systems().values()) <= OLDER


def test_no_system_of_gz_sim_counts_as_misspelt():
    """Such as EnvironmentalSystem, whose library is that of a sensor."""
    names = [(f"gz-sim-{kind}", f"gz::sim::systems::{name}") for name, kind in systems().items()]
    assert [name for name in names if misspelt_plugin(GazeboPlugin(*name))] == []

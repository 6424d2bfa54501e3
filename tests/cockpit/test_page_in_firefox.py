"""A sample of the page's tests in Firefox, one for each way to reach the twin; all: ``-m "browser and slow"``."""

# ruff: noqa: F401 (tests and fixtures are imported)

import pytest
from browser import NO_FIREFOX, page, show, started
from test_page_camera import test_names_stand_above_robots_and_follow_them
from test_page_driving import driven, test_keys_drive_the_chosen_robot_and_letting_go_stops_it
from test_page_sensors import test_a_scan_is_drawn_and_taken_away
from test_page_time import test_step_makes_so_many_steps
from test_page_world import crates, test_a_click_in_the_scene_selects_in_the_tree_and_shows_what_is_true_in_the_twin

pytestmark = [pytest.mark.browser, NO_FIREFOX]


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with started("firefox", tmp_path_factory.mktemp("browser")) as browser:
        yield browser

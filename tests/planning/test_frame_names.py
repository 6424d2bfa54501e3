import pytest

from drake_twin.planning.frame_names import misspelt_frame

LINKS = ("base_link", "base_footprint", "laser", "r1/camera_link")


@pytest.mark.parametrize(
    "frame",
    [
        "base_link",
        "/base_link",
        "robot_1/base_link",
        "robot_1_base_link",
        "camera_link",
        "",
        "odom",
        "zed_optical_frame",
    ],
)
def test_a_link_a_prefixed_link_and_a_frame_of_another_name_are_no_finding(frame):
    assert misspelt_frame(frame, LINKS) is None


def test_a_frame_that_is_nearly_a_link_names_it():
    assert misspelt_frame("base_lnk", LINKS) == "the robot has no link 'base_lnk'. Did you mean 'base_link'?"

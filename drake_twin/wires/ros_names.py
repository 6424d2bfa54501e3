"""Names of ROS 2 on any wire: topics, types and the domain."""

import os
import re

from drake_twin.errors import InputError

LARGEST_DOMAIN = 232  # docs.ros.org, "The ROS_DOMAIN_ID": DDS has no ports for more


def is_name(name: str) -> bool:
    """Tell whether a topic's or service's full name can be part of a key expression."""
    return re.fullmatch(r"(/[^/*$?#%@\s]+)+", name) is not None


def dds_type(ros_type: str) -> str:
    """Return the name that DDS has for a type: ``std_msgs::msg::dds_::String_`` for ``std_msgs/msg/String``."""
    package, folder, name = ros_type.split("/")
    return f"{package}::{folder}::dds_::{name}_"


def ros_type(dds: str) -> str:
    """Return the ROS type of DDS's name for it: the reverse of `dds_type`."""
    return dds.replace("::dds_::", "/").replace("::", "/").removesuffix("_")


def domain_of_environment() -> int:
    """Return ``ROS_DOMAIN_ID``, 0 by default.

    Raises:
        InputError: If it is not a domain.
    """
    text = os.environ.get("ROS_DOMAIN_ID", "").strip()
    if not text:
        return 0
    if not text.isascii() or not text.isdigit() or int(text) > LARGEST_DOMAIN:
        raise InputError(f"ROS_DOMAIN_ID={text}: a ROS domain is a whole number from 0 to {LARGEST_DOMAIN}")
    return int(text)

"""Stand-in for ``rosbag2_py._storage``: what readers and writers are told and tell."""

from dataclasses import field
from enum import IntEnum
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.qos import QoSProfile
from drake_twin.nodes.rclpy.time import Time


@dataclass
class ConverterOptions:
    """The formats of messages on both sides: ``cdr``, or nothing for it."""

    input_serialization_format: str = ""
    output_serialization_format: str = ""


@dataclass
class StorageOptions:
    """A bag: its folder, and ``mcap`` or ``sqlite3``."""

    uri: str
    storage_id: str = ""
    max_bagfile_size: int = 0
    max_bagfile_duration: int = 0
    max_cache_size: int = 0
    storage_preset_profile: str = ""
    storage_config_uri: str = ""
    snapshot_mode: bool = False
    start_time_ns: int = -1
    end_time_ns: int = -1
    custom_data: dict[str, str] = field(default_factory=dict)


@dataclass
class StorageFilter:
    """Which topics are read: those that are named or match; all by default."""

    topics: list[str] = field(default_factory=list)
    services_events: list[str] = field(default_factory=list)
    regex: str = ""
    exclude_topics: list[str] = field(default_factory=list)
    exclude_service_events: list[str] = field(default_factory=list)
    regex_to_exclude: str = ""


class ReadOrderSortBy(IntEnum):
    """What messages are sorted by."""

    ReceivedTimestamp = 0
    PublishedTimestamp = 1
    File = 2


@dataclass
class ReadOrder:
    """The order in which messages are read."""

    sort_by: ReadOrderSortBy = ReadOrderSortBy.ReceivedTimestamp
    reverse: bool = False


@dataclass(init=False)
class TopicMetadata:
    """A topic of a bag.

    Jazzy's constructor begins with ``id``, which Humble's does not have: both are taken.
    """

    id: int
    name: str
    type: str
    serialization_format: str
    offered_qos_profiles: Any
    type_description_hash: str

    def __init__(self, *given: Any, **named: Any):
        fields = ("id", "name", "type", "serialization_format", "offered_qos_profiles", "type_description_hash")
        if given[:1] and isinstance(given[0], str):
            given = (0, *given)
        defaults = {"id": 0, "offered_qos_profiles": [], "type_description_hash": ""}
        values = {**defaults, **dict(zip(fields, given, strict=False)), **named}
        if len(given) > len(fields) or values.keys() != set(fields):
            raise TypeError("__init__(): incompatible constructor arguments")
        for name, value in values.items():
            setattr(self, name, value)

    def equals(self, other: "TopicMetadata") -> bool:
        """Return whether both are the same."""
        return self == other


@dataclass
class TopicInformation:
    """A topic of a bag, and how many messages it has there."""

    topic_metadata: TopicMetadata
    message_count: int


@dataclass
class FileInformation:
    """A file of a bag."""

    path: str
    starting_time: Time
    duration: Duration
    message_count: int


@dataclass
class BagMetadata:
    """What is known of a bag."""

    version: int = 9
    bag_size: int = 0
    storage_identifier: str = ""
    relative_file_paths: list[str] = field(default_factory=list)
    files: list[FileInformation] = field(default_factory=list)
    duration: Duration = field(default_factory=Duration)
    starting_time: Time = field(default_factory=Time)
    message_count: int = 0
    topics_with_message_count: list[TopicInformation] = field(default_factory=list)
    compression_format: str = ""
    compression_mode: str = ""
    custom_data: dict[str, str] = field(default_factory=dict)
    ros_distro: str = ""


def get_default_storage_id() -> str:
    """Return the format of bags that name none."""
    return "mcap"


def convert_rclcpp_qos_to_rclpy_qos(qos_input: Any) -> QoSProfile:
    """Return a profile of a bag's topic as rclpy has it."""

    def duration(time: Any) -> Duration:
        return Duration(seconds=time.sec, nanoseconds=time.nsec)

    return QoSProfile(
        depth=qos_input.depth,
        history=int(qos_input.history),
        reliability=int(qos_input.reliability),
        durability=int(qos_input.durability),
        lifespan=duration(qos_input.lifespan),
        deadline=duration(qos_input.deadline),
        liveliness=int(qos_input.liveliness),
        liveliness_lease_duration=duration(qos_input.liveliness_lease_duration),
        avoid_ros_namespace_conventions=qos_input.avoid_ros_namespace_conventions,
    )

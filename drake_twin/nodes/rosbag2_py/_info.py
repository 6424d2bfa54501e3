"""Stand-in for ``rosbag2_py._info``."""

from pathlib import Path
from typing import Any

from drake_twin.description.bag_files import check_bag_files
from drake_twin.errors import InputError
from drake_twin.nodes.rclpy.clock_type import ClockType
from drake_twin.nodes.rclpy.duration import Duration
from drake_twin.nodes.rclpy.time import Time
from drake_twin.nodes.rosbag2_py._storage import BagMetadata, TopicInformation, TopicMetadata

_KINDS = {".mcap": "mcap", ".db3": "sqlite3"}


class Info:
    """Tells what is in a bag."""

    def read_metadata(self, uri: str, storage_id: str) -> BagMetadata:
        """Return what is known of a bag.

        Args:
            uri: Its folder, or a file.
            storage_id: Its format; what the file says counts.

        Raises:
            RuntimeError: If the bag does not exist.
        """
        with open_bag(uri) as reader:
            return metadata_of(reader, uri)


def open_bag(uri: str) -> Any:
    """Return a reader of a bag.

    Raises:
        RuntimeError: If the bag does not exist.
    """
    from rosbags.rosbag2 import Reader, ReaderError

    try:
        place = str(uri).removeprefix("file://")
        check_bag_files(Path(place))
        return Reader(place)
    except (InputError, OSError, ReaderError) as error:
        raise RuntimeError(f"No storage could be initialized from the inputs. ({error})") from None


def topic_of(connection: Any) -> TopicMetadata:
    """Return a topic as ROS tells it."""
    profiles = list(connection.ext.offered_qos_profiles)
    return TopicMetadata(connection.id, connection.topic, connection.msgtype, "cdr", profiles, connection.digest or "")


def metadata_of(reader: Any, uri: str) -> BagMetadata:
    """Return what is known of an open bag."""
    place = Path(str(uri).removeprefix("file://"))
    files = [file for file in sorted(place.iterdir()) if file.suffix in _KINDS] if place.is_dir() else [place]
    count = reader.message_count
    return BagMetadata(
        bag_size=sum(file.stat().st_size for file in files),
        storage_identifier=_KINDS.get(files[0].suffix, "") if files else "",
        relative_file_paths=[file.name for file in files],
        duration=Duration(nanoseconds=max(reader.duration - 1, 0)),  # rosbags' end is after the last message
        starting_time=Time(nanoseconds=reader.start_time if count else 0, clock_type=ClockType.SYSTEM_TIME),
        message_count=count,
        topics_with_message_count=[TopicInformation(topic_of(item), item.msgcount) for item in reader.connections],
        compression_format=reader.compression_format or "",
        compression_mode=reader.compression_mode or "",
        ros_distro=reader.ros_distro or "",
    )

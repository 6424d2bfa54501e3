"""Stand-in for ``rosbag2_py``: bags are read and written, over the package ``rosbags``.

There is neither ``Recorder``, ``Player``, ``Reindexer`` nor ``bag_rewrite``: a run writes a bag by ``--record``.
"""

from drake_twin.nodes.rosbag2_py._info import Info
from drake_twin.nodes.rosbag2_py._reader import SequentialCompressionReader, SequentialReader, get_registered_readers
from drake_twin.nodes.rosbag2_py._storage import (
    BagMetadata,
    ConverterOptions,
    FileInformation,
    ReadOrder,
    ReadOrderSortBy,
    StorageFilter,
    StorageOptions,
    TopicInformation,
    TopicMetadata,
    convert_rclcpp_qos_to_rclpy_qos,
    get_default_storage_id,
)
from drake_twin.nodes.rosbag2_py._writer import SequentialWriter, get_registered_serializers, get_registered_writers

__all__ = [
    "BagMetadata",
    "ConverterOptions",
    "FileInformation",
    "Info",
    "ReadOrder",
    "ReadOrderSortBy",
    "SequentialCompressionReader",
    "SequentialReader",
    "SequentialWriter",
    "StorageFilter",
    "StorageOptions",
    "TopicInformation",
    "TopicMetadata",
    "convert_rclcpp_qos_to_rclpy_qos",
    "get_default_storage_id",
    "get_registered_readers",
    "get_registered_serializers",
    "get_registered_writers",
]

"""Bags without definitions of their messages' types, as ROS 2 wrote them before Iron."""

import sqlite3

from playback.recorded_bags import write
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from drake_twin.playback.bag import Bag

KIND, TEXT = "nav_2d_msgs/msg/Pose2D32", "float32 x\nfloat32 y\nfloat32 theta\n"


def test_types_of_a_bag_without_definitions(tmp_path):
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(TEXT, KIND))
    data = bytes(store.serialize_cdr(store.types[KIND](1.0, 2.0, 0.5), KIND))
    folder = write(tmp_path / "bag", [("/home", KIND, 0.0, data)], store=store)
    (database,) = folder.glob("*.db3")
    with sqlite3.connect(database) as connection:
        connection.execute("DELETE FROM message_definitions")
    bag = Bag(folder)
    (found,) = (message.read() for message in bag.messages(lambda topic, kind: True))
    assert (found.x, found.y, found.theta) == (1.0, 2.0, 0.5)
    bag.close()

"""The side of interactive markers that a node has: it shows them, and hears what is done to them."""

from collections.abc import Callable
from copy import deepcopy
from dataclasses import field
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.nodes.message_classes import message_class, service_class

_CONFLICT = 1_000_000_000  # ns for which the feedback of another client is ignored
_Message = Any
Feedback = Callable[[_Message], object]


@dataclass
class _Marker:
    """A marker.

    Attributes:
        message: Its ``InteractiveMarker``, as it was shown last.
        feedback: Type of feedback → what is called with it.
        client: Who has moved it last.
        heard: When that was (ns).
    """

    message: _Message
    feedback: dict[int, Feedback] = field(default_factory=dict)
    client: str = ""
    heard: int = -_CONFLICT


class InteractiveMarkerServer:
    """Shows interactive markers. What changes is shown by `applyChanges`.

    Args:
        node: The node.
        namespace: The namespace of its topics ``update`` and ``feedback`` and its service ``get_interactive_markers``.
        update_pub_qos: The quality of service of ``update``, or its depth.
        feedback_sub_qos: That of ``feedback``.
    """

    DEFAULT_FEEDBACK_TYPE = 255

    def __init__(self, node: Any, namespace: str, *, update_pub_qos: Any = 100, feedback_sub_qos: Any = 100):
        self.node, self.topic_namespace = node, namespace
        self.sequence_number = 0
        self._markers: dict[str, _Marker] = {}
        self._new: dict[str, _Marker] = {}
        self._moved: dict[str, tuple[_Message, _Message]] = {}
        self._erased: dict[str, None] = {}
        self._update: Any = message_class("visualization_msgs/msg/InteractiveMarkerUpdate")
        self.update_pub = node.create_publisher(self._update, f"{namespace}/update", update_pub_qos)
        heard = message_class("visualization_msgs/msg/InteractiveMarkerFeedback")
        self.feedback_sub = node.create_subscription(
            heard, f"{namespace}/feedback", self.processFeedback, feedback_sub_qos
        )
        asked = service_class("visualization_msgs/srv/GetInteractiveMarkers")
        self.get_interactive_markers_srv = node.create_service(
            asked, f"{namespace}/get_interactive_markers", self.getInteractiveMarkersCallback
        )

    def shutdown(self) -> None:
        """Erase all markers."""
        self.clear()
        self.applyChanges()

    def insert(
        self,
        marker: _Message,
        *,
        feedback_callback: Feedback | None = None,
        feedback_type: int = DEFAULT_FEEDBACK_TYPE,
    ) -> None:
        """Add a marker (``InteractiveMarker``), or replace the one of its name."""
        known = self._new.get(marker.name) or self._markers.get(marker.name)
        self._new[marker.name] = _Marker(deepcopy(marker), {} if known is None else known.feedback)
        self._erased.pop(marker.name, None)
        self._moved.pop(marker.name, None)
        if feedback_callback is not None:
            self.setCallback(marker.name, feedback_callback, feedback_type)

    def setPose(self, name: str, pose: _Message, header: _Message = None) -> bool:
        """Move a marker that is shown; return whether it is there."""
        if name not in self._markers or name in self._new:
            return False
        own = self._markers[name].message.header
        self._moved[name] = deepcopy(pose), deepcopy(header if header is not None and header.frame_id else own)
        return True

    def erase(self, name: str) -> bool:
        """Remove a marker; return whether it is there."""
        is_there = name in self._markers or name in self._new
        self._new.pop(name, None)
        self._moved.pop(name, None)
        if name in self._markers:
            self._erased[name] = None
        return is_there

    def clear(self) -> None:
        """Remove all markers."""
        for name in (*self._new, *self._markers):
            self.erase(name)

    def setCallback(self, name: str, feedback_callback: Feedback | None, feedback_type: int = 255) -> bool:
        """Let feedback of a type, or that of all other types, be heard; return whether the marker is there."""
        marker = self._new.get(name) or self._markers.get(name)
        if marker is None:
            return False
        if feedback_callback is None:
            marker.feedback.pop(feedback_type, None)
        else:
            marker.feedback[feedback_type] = feedback_callback
        return True

    def applyChanges(self) -> None:
        """Show what has changed."""
        if not (self._new or self._moved or self._erased):
            return
        update = self._update(type=self._update.UPDATE)
        kind = message_class("visualization_msgs/msg/InteractiveMarkerPose")
        for name, marker in self._new.items():
            self._markers[name] = marker
            update.markers.append(marker.message)
        for name, (pose, header) in self._moved.items():
            message = self._markers[name].message
            message.pose, message.header = pose, header
            update.poses.append(kind(name=name, pose=pose, header=header))
        for name in self._erased:
            del self._markers[name]
            update.erases.append(name)
        self._new, self._moved, self._erased = {}, {}, {}
        self.sequence_number += 1
        update.seq_num = self.sequence_number
        self.update_pub.publish(update)

    def get(self, name: str) -> _Message:
        """Return a copy of a marker with its changes; None if it is not there."""
        marker = self._new.get(name) or self._markers.get(name)
        if marker is None or name in self._erased:
            return None
        found = deepcopy(marker.message)
        if name in self._moved:
            found.pose, found.header = self._moved[name]
        return found

    def processFeedback(self, feedback: _Message) -> None:
        """Hear what is done to a marker; for a second only the client that has begun it is heard."""
        marker = self._markers.get(feedback.marker_name)
        now = self.node.get_clock().now().nanoseconds
        if marker is None or (marker.client != feedback.client_id and now - marker.heard < _CONFLICT):
            return
        marker.client, marker.heard = feedback.client_id, now
        if feedback.event_type == feedback.POSE_UPDATE:
            stamp = marker.message.header.stamp
            follows = stamp.sec or stamp.nanosec  # a marker with the time zero stays in its own frame
            self.setPose(feedback.marker_name, feedback.pose, feedback.header if follows else None)
        call = marker.feedback.get(feedback.event_type) or marker.feedback.get(self.DEFAULT_FEEDBACK_TYPE)
        if call is not None:
            call(feedback)

    def getInteractiveMarkersCallback(self, request: _Message, response: _Message) -> _Message:
        """Answer with all markers that are shown."""
        response.sequence_number = self.sequence_number
        response.markers = [marker.message for marker in self._markers.values()]
        return response

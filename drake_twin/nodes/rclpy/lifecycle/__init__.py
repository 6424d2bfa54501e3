"""Stand-in for ``rclpy.lifecycle``: nodes with states, which services and the program change."""

from drake_twin.nodes.rclpy.lifecycle.managed_entity import ManagedEntity, SimpleManagedEntity
from drake_twin.nodes.rclpy.lifecycle.node import LifecycleNode, LifecycleNodeMixin
from drake_twin.nodes.rclpy.lifecycle.publisher import LifecyclePublisher
from drake_twin.nodes.rclpy.lifecycle.state_machine import LifecycleState
from drake_twin.nodes.rclpy.lifecycle.state_machine import TransitionCallbackReturn as TransitionCallbackReturn

# Their shorter names in rclpy.
Node, NodeMixin, Publisher, State = LifecycleNode, LifecycleNodeMixin, LifecyclePublisher, LifecycleState

__all__ = [
    "LifecycleNode",
    "LifecycleNodeMixin",
    "LifecyclePublisher",
    "LifecycleState",
    "ManagedEntity",
    "SimpleManagedEntity",
]

"""Stand-in for ``rclpy.lifecycle.publisher``."""

from typing import Any

from drake_twin.nodes.rclpy.lifecycle.managed_entity import SimpleManagedEntity
from drake_twin.nodes.rclpy.publisher import Publisher


class LifecyclePublisher(SimpleManagedEntity, Publisher):
    """A publisher that is silent while its node is not active."""

    def __init__(self, *args: Any, **kwargs: Any):
        SimpleManagedEntity.__init__(self)
        Publisher.__init__(self, *args, **kwargs)

    def publish(self, msg: Any) -> None:
        if self._enabled:
            Publisher.publish(self, msg)

"""Another program of the machine's own ROS 2 on the graph of a twin: prints what it has found, as JSON."""

import itertools
import json
import sys
import time

import rclpy
from rcl_interfaces.srv import ListParameters
from rclpy.qos import DurabilityPolicy, QoSProfile
from sensor_msgs.msg import JointState
from std_msgs.msg import Float64MultiArray, String

CALLS, STATES = 1000, 300
_PATIENCE = 100.0  # s


def spin(until):
    end = time.monotonic() + _PATIENCE
    while not until() and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)
    return until()


rclpy.init(domain_id=int(sys.argv[1]))
node = rclpy.create_node("peer")
found = {}
stamps, speeds, descriptions = [], [], []


def hear(message):
    stamps.append(message.header.stamp.sec * 10**9 + message.header.stamp.nanosec)
    speeds.append(message.velocity[0])


node.create_subscription(JointState, "/robot_1/joint_states", hear, QoSProfile(depth=1000))
late = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
node.create_subscription(String, "/robot_1/robot_description", lambda message: descriptions.append(message.data), late)
spin(lambda: len(stamps) >= STATES and descriptions)
found["periods"] = sorted({after - before for before, after in itertools.pairwise(stamps)})
found["descriptions"] = descriptions
client = node.create_client(ListParameters, "/robot_1/robot_state_publisher/list_parameters")
spin(client.service_is_ready)
answered = 0
for _ in range(CALLS):
    future = client.call_async(ListParameters.Request())
    answered += spin(future.done) and "robot_description" in future.result().result.names
found["answered"] = answered
publisher = node.create_publisher(Float64MultiArray, "/robot_1/forward_velocity_controller/commands", 10)
spin(lambda: publisher.get_subscription_count() == 1)
publisher.publish(Float64MultiArray(data=[3.0] * 4))
found["moves"] = spin(lambda: speeds[-1] > 1)
found["nodes"] = sorted(
    f"{namespace.rstrip('/')}/{name}" for name, namespace in node.get_node_names_and_namespaces() if name[0] != "_"
)
print(json.dumps(found))

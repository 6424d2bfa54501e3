"""Lesson 2 once more: the commander as a program of its own, beside a running twin and without ROS.

Run it: python diagrams/commander.py
Beside: python -m drake_twin.run --robots 2 --ros zenoh

It finds the robots on the graph and drives them ahead for two seconds of the twin's time, each with its own speed: a
NumPy array with a row for each robot, and a Float64MultiArray publisher for each row. Another address than the twin's
default one is its argument: HOST or HOST:PORT.
"""

import queue
import sys

import numpy as np

from drake_twin.client import Client

COMMANDS = "/forward_velocity_controller/commands"
SECONDS = 2.0

with Client(*sys.argv[1:]) as client:
    topics = [topic for topic, kind in client.topics().items() if topic.endswith(COMMANDS)]
    publishers = [client.publisher(topic) for topic in topics]
    for publisher in publishers:
        publisher.wait_for_subscriber()
    speeds = np.linspace(3.0, 6.0, len(topics))  # rad/s of each robot's wheels

    times = queue.SimpleQueue()
    client.subscribe("/clock", lambda message: times.put(message.clock.sec + 1e-9 * message.clock.nanosec))
    start = times.get()
    while (now := times.get()) < start + SECONDS:
        factor = 1 - 0.5 * np.cos(np.pi * (now - start))  # slower and faster
        wheels = factor * np.tile(speeds[:, None], 4)  # a row for each robot, a column for each wheel
        for publisher, row in zip(publishers, wheels, strict=True):
            publisher.publish({"data": row})
    for publisher in publishers:
        publisher.publish({"data": np.zeros(4)})

for topic, speed in zip(topics, speeds, strict=True):
    print(f"{topic.removesuffix(COMMANDS)} was driven at {speed:.1f} rad/s on average for {SECONDS:.0f} s")

"""A ROS participant that publishes its name until its standard input is closed.

It prints one line: "heard" as soon as it has heard another, or "not heard" after SECONDS.

Usage: peer.py NAME SECONDS [INTERFACE]; opens itself to INTERFACE as `--network` does.
"""

import os
import select
import sys
import time

import rclpy
from std_msgs.msg import String

from pack_bringup.graph.network import network_environment
from pack_core.network import PROFILE_VARIABLE
from pack_core.ros.run import start_ros

name, seconds = sys.argv[1], float(sys.argv[2])
if sys.argv[3:]:
    os.environ.update(network_environment(sys.argv[3]))
if PROFILE_VARIABLE in os.environ:
    start_ros()
else:  # a stranger
    rclpy.init()
node = rclpy.create_node(name)
heard = set()
node.create_subscription(String, "/names", lambda message: heard.add(message.data), 10)
publisher = node.create_publisher(String, "/names", 10)


def publish() -> None:
    publisher.publish(String(data=name))
    time.sleep(0.05)  # what it hears of itself would end every wait at once
    rclpy.spin_once(node, timeout_sec=0.0)
    rclpy.spin_once(node, timeout_sec=0.0)


deadline = time.monotonic() + seconds
while not heard - {name} and time.monotonic() < deadline:
    publish()
sys.stdout.write("heard\n" if heard - {name} else "not heard\n")
sys.stdout.flush()
while not select.select([sys.stdin], [], [], 0)[0]:  # the other may need longer to hear us
    publish()

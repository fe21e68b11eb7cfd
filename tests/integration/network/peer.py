"""A ROS participant that publishes its name, and ends with exit code 0 once it has heard the other, else 3.

Usage: peer.py NAME SECONDS [INTERFACE]; opens itself to INTERFACE as `--network` does.
"""

import os
import sys
import time

import rclpy
from std_msgs.msg import String

from pack_bringup.graph.network import network_environment

NOT_HEARD = 3
name, seconds = sys.argv[1], float(sys.argv[2])
if sys.argv[3:]:
    os.environ.update(network_environment(sys.argv[3]))
rclpy.init()
node = rclpy.create_node(name)
heard = set()
node.create_subscription(String, "/names", lambda message: heard.add(message.data), 10)
publisher = node.create_publisher(String, "/names", 10)
deadline = time.monotonic() + seconds
while not heard - {name} and time.monotonic() < deadline:
    publisher.publish(String(data=name))
    rclpy.spin_once(node, timeout_sec=0.05)
for _ in range(20):  # the other needs to hear us, too
    publisher.publish(String(data=name))
    rclpy.spin_once(node, timeout_sec=0.05)
sys.exit(0 if heard - {name} else NOT_HEARD)

"""Loopback-only transports carry a 4K picture as fast as the middleware's own defaults."""

import os
import statistics
import subprocess
import sys

import pytest

pytestmark = [pytest.mark.benchmark, pytest.mark.timeout(300)]

SENDER = """
import sys, time, numpy as np, rclpy
from sensor_msgs.msg import Image
rclpy.init()
node = rclpy.create_node("sender")
publisher = node.create_publisher(Image, "/picture", 5)
picture = Image(height=2160, width=3840, encoding="rgb8", step=3 * 3840)
picture.data = np.zeros(2160 * 3840 * 3, np.uint8).tobytes()
while not publisher.get_subscription_count():
    time.sleep(0.05)
while True:
    stamp = time.time_ns()
    picture.header.stamp.sec, picture.header.stamp.nanosec = stamp // 10**9, stamp % 10**9
    publisher.publish(picture)
    time.sleep(0.15)
"""
RECEIVER = """
import sys, time, rclpy
from sensor_msgs.msg import Image
rclpy.init()
node = rclpy.create_node("receiver")
delays = []
def take(picture):
    stamp = picture.header.stamp
    delays.append(time.time() - stamp.sec - stamp.nanosec * 1e-9)
node.create_subscription(Image, "/picture", take, 5)
while len(delays) < 15:
    rclpy.spin_once(node, timeout_sec=1.0)
print(*delays)
"""
OURS = dict(os.environ)
MIDDLEWARE_DEFAULTS = {
    name: value for name, value in OURS.items() if name != "FASTRTPS_DEFAULT_PROFILES_FILE"
}
MIDDLEWARE_DEFAULTS["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"


def median_delay(environment: dict[str, str], domain: int) -> float:
    """Median time from before `publish()` to the callback of another process [s], 25 MB a picture."""
    environment = environment | {"ROS_DOMAIN_ID": str(domain)}
    sender = subprocess.Popen([sys.executable, "-c", SENDER], env=environment)
    try:
        done = subprocess.run(
            [sys.executable, "-c", RECEIVER], env=environment, capture_output=True, text=True, check=True
        )
    finally:
        sender.kill()
        sender.wait()
    return statistics.median(map(float, done.stdout.split()))


def test_pictures_travel_as_fast_as_with_the_middleware_defaults() -> None:
    ratios, delays = [], []
    for k in range(3):
        ours, theirs = median_delay(OURS, 81 + k), median_delay(MIDDLEWARE_DEFAULTS, 91 + k)
        ratios.append(ours / theirs)
        delays.append(ours)
    ratio = statistics.median(ratios)
    sys.stdout.write(f"4K picture: {1e3 * statistics.median(delays):.1f} ms, {ratio:.2f} of the default\n")
    assert ratio < 1.25

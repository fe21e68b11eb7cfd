"""What cells with an overhead camera have on its wires."""

from __future__ import annotations

from sensor_msgs.msg import CameraInfo, Image
from std_srvs.srv import Trigger

from pack_core.ros.contracts.contract import LATCHED, LATEST, Contract, Kind


def overhead_camera(vision: str) -> tuple[Contract, Contract, Contract]:
    """The camera's trigger, its pictures and its intrinsics, for the node `vision` that looks at them."""
    trigger = Contract(
        "/camera/trigger", Trigger, ("fsm", "user"), ("sim",),
        "take a picture now; it follows, stamped with this moment", kind=Kind.SERVICE,
    )  # fmt: skip
    image = Contract(
        "/camera/image_raw", Image, ("sim",), (vision,), "picture of the overhead camera, rgb8", qos=LATEST,
        rate="on demand",
    )  # fmt: skip
    info = Contract(
        "/camera/camera_info", CameraInfo, ("sim",), (vision, "recorder"),
        "intrinsics of the overhead camera", qos=LATCHED, rate="with each picture", recorded=True,
    )  # fmt: skip
    return trigger, image, info

"""Scans as point clouds and back, and clouds that must not be used."""

from __future__ import annotations

from array import array

import numpy as np
import pytest
from sensor_msgs.msg import PointCloud2

from pack_core.errors import MessageError
from pack_core.palletizing.scanner import PlaceScan
from pack_core.ros.messages.palletizing import from_cloud, to_cloud

SCAN = PlaceScan(12.5, "pallet", np.array([[0.1, -0.2, 3.5], [0.0, 0.4, 3.856]]))


def test_a_scan_comes_back_as_it_was() -> None:
    back = from_cloud(to_cloud(SCAN), "pallet")
    assert (back.time, back.place) == (12.5, "pallet")
    assert back.points == pytest.approx(SCAN.points, abs=1e-6)


def spoiled(what: str) -> PointCloud2:
    message = to_cloud(SCAN)
    if what == "frame":
        message.header.frame_id = "world"
    elif what == "fields":
        message.fields = message.fields[:2]
    elif what == "bytes":
        message.data = message.data[:-1]
    elif what == "nothing":
        message.width, message.data = 0, array("B")
    elif what == "at the scanner":
        message = to_cloud(PlaceScan(12.5, "pallet", np.zeros((2, 3))))
    else:
        message = to_cloud(PlaceScan(12.5, "pallet", np.full((2, 3), np.nan)))
    return message


@pytest.mark.parametrize(
    ("what", "reason"),
    [
        ("frame", "allowed: pallet_scanner"),
        ("fields", "2 fields"),
        ("bytes", "23 bytes"),
        ("nothing", "0 points"),
        ("at the scanner", "nearer to the scanner"),
        ("not a number", "not finite"),
    ],
)
def test_a_cloud_that_no_scanner_sends_is_refused_with_the_reason(what: str, reason: str) -> None:
    with pytest.raises(MessageError, match=reason):
        from_cloud(spoiled(what), "pallet")

#!/usr/bin/env bash
# Makes keys for the nodes of a cell, so that only who has one of them can join it (SROS 2, docs/operate/security.md).
# Needs ROS 2 from apt (/opt/ros/jazzy): the wheels on PyPI are built without DDS security.
set -euo pipefail

if [ $# -ne 2 ]; then
    echo "usage: tools/keystore.sh CELL DIR    e.g. tools/keystore.sh packing ~/packcell_keys" >&2
    exit 2
fi
cell=$1 keystore=$2
graph="$(dirname "$0")/../config/graphs/$cell.yaml"
if [ ! -f "$graph" ]; then
    echo "error: no cell '$cell'; allowed: $(cd "$(dirname "$graph")" && ls ./*.yaml | sed 's|\./||; s|\.yaml||' | paste -sd' ')" >&2
    exit 2
fi
if ! ros2 security --help >/dev/null 2>&1; then
    echo "error: no command 'ros2 security'; on a machine with /opt/ros/jazzy: apt-get install ros-jazzy-sros2" >&2
    exit 2
fi

umask 077 # the keys are for this user alone
[ -d "$keystore/enclaves" ] || ros2 security create_keystore "$keystore"
# `operator` is for whoever sends goals and looks on: pack goal, ros2 topic, RViz.
for node in $(sed -n 's/^ *- *{ *name: *\([a-z_]*\).*/\1/p' "$graph") operator; do
    ros2 security create_enclave "$keystore" "/packcell/$cell/$node"
done
echo "keys of the cell $cell are in $keystore; start it with keystore:=$keystore (docs/operate/security.md)"

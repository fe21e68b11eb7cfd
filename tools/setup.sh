#!/usr/bin/env bash
# Makes the workspace ready to run: system packages, .venv, colcon build, commands. Does only what has changed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
root=$PWD
venv=$root/.venv

find_python() {
    local candidate
    for candidate in ${PYTHON:-"$venv/bin/python" python3 python3.12 python3.11}; do
        if "$candidate" -c 'import sys; sys.exit(sys.version_info[:2] not in ((3, 11), (3, 12)))' 2>/dev/null; then
            "$candidate" -c 'import sys; print(getattr(sys, "_base_executable", sys.executable))'
            return
        fi
    done
    echo "No Python 3.11 or 3.12 found (tried: ${PYTHON:-python3 python3.12 python3.11})." >&2
    echo "Debian 12: sudo apt-get install -y python3.11-venv python3.11-dev; Ubuntu 24.04: the same with 3.12." >&2
    echo "Elsewhere name one: make setup PYTHON=/path/to/python3.12" >&2
    return 1
}

check_machine() {
    [ "$(uname -sm)" = "Linux x86_64" ] && return
    echo "The ROS 2 wheels exist for x86-64 Linux only; this is $(uname -sm). docs/operate/apt.md is the way without them." >&2
    return 1
}

hash_of() { cat "$@" | sha256sum | cut -c1-16; }
is_stamped() { [ "$(cat "$1" 2>/dev/null)" = "$2" ]; }

install_requirements() {
    local place requirements
    place="$venv $("$python" -c 'import sys; print(sys.base_prefix, *sys.version_info[:2])')"
    requirements=$(hash_of requirements/locked.txt)
    if ! is_stamped "$venv/.place" "$place"; then
        echo "Setting up for the first time takes 2 to 5 minutes"
        echo "Creating .venv with $("$python" --version)"
        rm -rf "$venv" ros_ws/build ros_ws/install ros_ws/log
        "$python" -m venv "$venv"
        "$venv/bin/python" -m pip install -q --disable-pip-version-check uv==0.13.8
        echo "$place" >"$venv/.place"
    fi
    if ! is_stamped "$venv/.requirements" "$requirements"; then
        echo "Installing ROS 2 Jazzy and the Python packages of requirements/locked.txt"
        "$venv/bin/uv" pip install -q --python "$venv/bin/python" --compile-bytecode \
            --require-hashes -r requirements/locked.txt
        echo "$requirements" >"$venv/.requirements"
    fi
    ln -sf ../tools/local_setup.bash "$venv/local_setup.bash"
}

build_workspace() {
    local sources key
    mapfile -t sources < <(find ros_ws/src -type f \( -path '*/pack_interfaces/*' -o -path '*/tf2_msgs/*' -o -path '*/control_msgs/*' \
        -o -name package.xml -o -name setup.py -o -name setup.cfg -o -name colcon.pkg \) | LC_ALL=C sort)
    key=$(hash_of "$venv/.requirements" tools/wheels_fix.cmake "${sources[@]}")
    is_stamped ros_ws/install/.sources "$key" && return
    echo "Building the workspace (about a minute the first time)"
    (
        unset AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH PYTHONPATH
        source "$venv/bin/activate"
        source "$venv/local_setup.bash"
        cd ros_ws
        # Without it colcon tells ninja to wait until the machine is idle, which a busy machine never is.
        MAKEFLAGS="${MAKEFLAGS:--j$(nproc)}" colcon build --symlink-install --event-handlers console_start_end- \
            --cmake-args -GNinja "-DCMAKE_PROJECT_INCLUDE=$root/tools/wheels_fix.cmake"
    )
    find ros_ws/install -xtype l -delete # colcon leaves links to sources that are gone
    echo "$key" >ros_ws/install/.sources
}

# Numba compiles anew what changed, but not what calls it.
forget_compiled() {
    local sources key
    mapfile -t sources < <(grep -rl --include='*.py' njit ros_ws/src | LC_ALL=C sort)
    key=$(hash_of "${sources[@]}")
    is_stamped "$venv/.compiled" "$key" && return
    find ros_ws/src \( -name '*.nbi' -o -name '*.nbc' \) -delete
    echo "$key" >"$venv/.compiled"
}

# Where Python must not write beside its sources (PYTHONDONTWRITEBYTECODE, as in many containers), every node would
# compile all that it imports at every start: 4 s of the processor.
compile_bytecode() { "$venv/bin/python" -m compileall -qq ros_ws/src || true; }

has_own_ros2() { PATH=$(tr : '\n' <<<"$PATH" | grep -vFx "$venv/bin" | paste -sd:) command -v ros2 >/dev/null; }

link_commands() {
    ln -sf ../../tools/pack "$venv/bin/pack"
    if has_own_ros2; then rm -f "$venv/bin/ros2"; else ln -sf ../../tools/ros2 "$venv/bin/ros2"; fi
}

check_machine
tools/system_packages.sh "$(find_python 2>/dev/null || true)"
python=$(find_python)
install_requirements
build_workspace
forget_compiled
compile_bytecode
link_commands
echo "PackCell is ready: .venv/bin/pack --help"

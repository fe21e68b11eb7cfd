# The environment of the workspace, to be sourced by bash: `source tools/env.sh`.
# What is set already is kept, so every default below can be changed from outside.

PACKCELL_ROOT="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
export PACKCELL_ROOT

if [ ! -f "$PACKCELL_ROOT/ros_ws/install/local_setup.bash" ]; then
    echo "PackCell is not set up yet: run 'make setup' in $PACKCELL_ROOT" >&2
    return 1
fi
case ":${AMENT_PREFIX_PATH:-}:" in
*:/opt/ros/*)
    echo "This shell has sourced /opt/ros; .venv brings its own ROS 2 and the two do not mix." >&2
    echo "Open a shell without it, or follow docs/operate/apt.md to use /opt/ros instead of .venv." >&2
    return 1
    ;;
esac

source "$PACKCELL_ROOT/.venv/bin/activate"
source "$PACKCELL_ROOT/.venv/local_setup.bash"
source "$PACKCELL_ROOT/ros_ws/install/local_setup.bash"

export RMW_IMPLEMENTATION="${RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}"
export MUJOCO_GL="${MUJOCO_GL:-egl}"

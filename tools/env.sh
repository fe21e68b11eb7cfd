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

# What the shell has sourced of another checkout would be imported instead of this one's.
_without_other_checkouts() {
    local entry root kept=
    while IFS= read -r -d : entry; do
        root=${entry%%/ros_ws/*}
        root=${root%%/.venv*}
        [ "$root" != "$PACKCELL_ROOT" ] && [ -f "$root/tools/env.sh" ] && [ -d "$root/ros_ws" ] && continue
        kept+=${kept:+:}$entry
    done <<<"$1:"
    printf %s "$kept"
}
for _variable in PYTHONPATH LD_LIBRARY_PATH AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH; do
    if [ -n "${!_variable:-}" ]; then export "$_variable=$(_without_other_checkouts "${!_variable}")"; fi
done
unset -f _without_other_checkouts
unset _variable

source "$PACKCELL_ROOT/.venv/bin/activate"
source "$PACKCELL_ROOT/.venv/local_setup.bash"
source "$PACKCELL_ROOT/ros_ws/install/local_setup.bash"

export RMW_IMPLEMENTATION="${RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}"
export MUJOCO_GL="${MUJOCO_GL:-egl}"
# Every matrix here is small. Threads for them win nothing, and wait for each other in busy loops: on two busy cores a
# singular value decomposition takes 20 to 200 times as long with two threads as with one.
export OPENBLAS_NUM_THREADS="${OPENBLAS_NUM_THREADS:-1}"

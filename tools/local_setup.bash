# Set-up puts this into .venv, so that the ament index and colcon find the ROS 2 wheels there.
_packcell_venv="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
case ":${AMENT_PREFIX_PATH:-}:" in
*":$_packcell_venv:"*) ;;
*)
    export AMENT_PREFIX_PATH="$_packcell_venv${AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}"
    export CMAKE_PREFIX_PATH="$_packcell_venv${CMAKE_PREFIX_PATH:+:$CMAKE_PREFIX_PATH}"
    ;;
esac
unset _packcell_venv

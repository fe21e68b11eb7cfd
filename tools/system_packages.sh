#!/usr/bin/env bash
# Sees to the apt packages that set-up and rendering need: installs them as root, else names the command.
# Usage: system_packages.sh PYTHON (empty where there is none that fits)
set -euo pipefail
python=$1
libraries=$(PATH=$PATH:/sbin:/usr/sbin ldconfig -p)

has_library() { grep -q "$1" <<<"$libraries"; }
has_venv() { "$python" -c 'import ensurepip, venv' 2>/dev/null; }
has_headers() { "$python" -c 'import sys, sysconfig, pathlib
sys.exit(not pathlib.Path(sysconfig.get_path("include"), "Python.h").is_file())'; }
has_gl_driver() { compgen -G '/usr/lib/x86_64-linux-gnu/dri/*_dri.so' >/dev/null || has_library libEGL_nvidia; }

missing=()
command -v g++ >/dev/null || missing+=(g++)
if [ -n "$python" ]; then
    version=$("$python" -c 'import sys; print(f"python3.{sys.version_info.minor}")')
    has_venv || missing+=("$version-venv")
    has_headers || missing+=("$version-dev")
elif ! command -v python3 >/dev/null; then
    missing+=(python3 python3-venv python3-dev)
fi
has_library libEGL.so.1 || missing+=(libegl1)
has_library libOpenGL.so.0 || missing+=(libopengl0)
has_gl_driver || missing+=(libgl1-mesa-dri)
# Only tests of the page need a browser: set-up goes on without one. Ubuntu's chromium is a snap.
is_debian() { grep -qx 'ID=debian' /etc/os-release 2>/dev/null; }
can_install() { [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; }
if can_install && is_debian && ! command -v chromium >/dev/null; then missing+=(chromium libgl1-mesa-dri); fi
[ ${#missing[@]} -eq 0 ] && exit 0

if can_install; then
    echo "Installing system packages: ${missing[*]}"
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
else
    echo "System packages are missing. Run: sudo apt-get install -y ${missing[*]}" >&2
    exit 1
fi

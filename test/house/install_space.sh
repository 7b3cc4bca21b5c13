#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# install_space.sh <build folder> <its install prefix>: all that belongs to an install space gets there, rosrun finds the nodes, and
# the default scene starts. The space lies in a folder that goes when the test ends.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
set -e
source=$(cd "$(dirname "$(readlink -f "$0")")/../.." && pwd)
unset PYTHONPATH CMAKE_PREFIX_PATH ROS_PACKAGE_PATH LD_LIBRARY_PATH
launched=
folder=$(mktemp -d)
finish() {
  [ -z "$launched" ] || { kill -INT "$launched" && wait "$launched"; } || true
  rm -rf "$folder"
}
trap finish EXIT
fail() {
  echo "install_space: $*" >&2
  cat "$folder"/*.log >&2
  exit 1
}

DESTDIR=$folder cmake --install "$1" >"$folder/install.log" || fail "nothing is installed"
space=$folder$2
. "$space/setup.bash"
cd "$folder"
share=$(rospack find polyscalpel)
[ "$share" = "$space/share/polyscalpel" ] || fail "rospack finds $share"
for part in launch config msg srv; do
  diff -r "$source/$part" "$share/$part" || fail "$part differs from the source's"
done
while read -r header; do
  [ -f "$space/$header" ] || fail "$header is not there"
done < <(cd "$source" && find include -name '*.hpp')
[ -f "$space/include/polyscalpel/StepStatus.h" ] || fail "the messages' headers are not there"
[ "$(python3 -c 'import polyscalpel.msg; print(polyscalpel.msg.__file__)')" = \
  "$space/lib/python3/dist-packages/polyscalpel/msg/__init__.py" ] || fail "the messages' Python is not there"

port=$(python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])')
export ROS_MASTER_URI=http://localhost:$port
roslaunch -p "$port" polyscalpel simulation.launch >"$folder/roslaunch.log" 2>&1 &
launched=$!
for _ in {1..600}; do
  kill -0 "$launched" 2>/dev/null || fail "the scene does not start"
  ! rosservice list 2>/dev/null | grep -qx /reset || break
  sleep 0.1
done
timeout 60 rostopic echo -n 1 /status/step >"$folder/status.log" || fail "no status is published"
# Without a path the tool says so and ends; a second simulation that has no scene as well.
! rosrun polyscalpel simulated_tool </dev/null >"$folder/tool.log" 2>&1 || fail "a tool without a path runs"
grep -q "path is missing" "$folder/tool.log" || fail "rosrun does not start simulated_tool"
! rosrun polyscalpel polyscalpel_node __name:=second </dev/null >"$folder/node.log" 2>&1 || fail "a simulation without a scene runs"
grep -q "scene is missing" "$folder/node.log" || fail "rosrun does not start polyscalpel_node"

#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# package.xml and CMakeLists.txt hold against each other. The script `run` is for a checkout: it is not installed.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
cd "$(dirname "$(readlink -f "$0")")/../.." || exit 1
exec catkin_lint -q --offline --strict --ignore uninstalled_script .

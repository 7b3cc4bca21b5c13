#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Every C++ file is as clang-format leaves it, and carries the licence line first.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
set -u
cd "$(dirname "$(readlink -f "$0")")/../.." || exit 1
mapfile -t files < <(find src include test -name '*.cpp' -o -name '*.hpp' | sort)
[ "${#files[@]}" -gt 0 ] || { echo "no C++ files found"; exit 1; }
status=0
for file in "${files[@]}"; do
  [ "$(head -n 1 "$file")" = "// SPDX-License-Identifier: BSD-3-Clause" ] || { echo "$file: the licence line is not first"; status=1; }
done
clang-format --dry-run -Werror "${files[@]}" || status=1
exit $status

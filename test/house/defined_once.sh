#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# No function of ours is defined in two of the given libraries: the one that is loaded first would take the other's place.
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
set -eu -o pipefail
[ "$#" -ge 2 ] || { echo "usage: $0 <library> <library> ..."; exit 2; }
defined=$(for library in "$@"; do nm -DC --defined-only "$library" | sed -n 's/^[0-9a-f]* T \(polyscalpel::.*\)/\1/p' | sort -u; done)
[ -n "$defined" ] || { echo "nothing of ours is defined in $*"; exit 1; }
twice=$(sort <<<"$defined" | uniq -d)
[ -z "$twice" ] || { printf 'defined twice:\n%s\n' "$twice"; exit 1; }

#!/usr/bin/env bash
# Line coverage of the .cpp files of src/ and app/ from plain gcov, for machines without gcovr.
# usage: coverage.sh SOURCE_DIR BINARY_DIR
set -euo pipefail

source_dir=$1
binary_dir=$2

find "$binary_dir/src" "$binary_dir/app" -name '*.gcda' -print0 |
  xargs -0 -r gcov --no-output --source-prefix "$source_dir" --relative-only 2>/dev/null |
  awk -F"'" '
    /^File / { file = $2 }
    /^Lines executed:/ && file ~ /\.cpp$/ {
      split($0, part, /[:% ]+/)
      print file, part[3], part[5]
      file = ""
    }' |
  sort |
  awk '
    { printf "%6.1f %%  %5d lines  %s\n", $2, $3, $1; executed += $2 * $3 / 100; total += $3 }
    END { if (total) printf "%6.1f %%  %5d lines  in all\n", 100 * executed / total, total }'

#!/usr/bin/env bash
# Installs the packed npm package in an empty project and runs the lines of its README there, and the tests of the package.
# usage: package_test.sh PACKAGE-FOLDER TEST-FOLDER; exit status 77: npm is absent
set -euo pipefail

package=$(realpath "$1")
tests=$(realpath "$2")
if ! command -v npm >/dev/null || ! command -v node >/dev/null; then
  echo "skipped: npm and node are not installed"
  exit 77
fi

project=$(mktemp -d)
trap 'rm -rf "$project"' EXIT
cd "$project"
export npm_config_cache=$project/cache npm_config_update_notifier=false
archive=$(npm pack --silent "$package")
echo '{"name": "empty", "private": true, "type": "module"}' >package.json
npm install --silent --offline --no-audit --no-fund "./$archive"
sed -n '/^```js$/,/^```$/{/^```/!p}' node_modules/csrbf/README.md >readme.mjs
[[ $(wc -l <readme.mjs) -ge 10 ]] || { echo "the README has no lines to run"; exit 1; }
node readme.mjs | tee readme.txt
grep -qE '^[0-9]+ vertices, [0-9]+ triangles$' readme.txt
cp "$tests"/*.mjs .
for program in $(ls -t "$tests"/../../build/*/bin/csrbf 2>/dev/null); do  # the newest that runs here
  "$program" --version >/dev/null 2>&1 && export CSRBF_PROGRAM=$program && break
done
node --test ./*_test.mjs

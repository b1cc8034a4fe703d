#!/usr/bin/env bash
# Brings the Stanford bunny (npm package "bunny", 2503 vertices, public domain as packaged) as assets/meshes/bunny.obj for the scene bunny_rain.
#   bash assets/fetch_bunny.sh
set -u
here="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)"
say() { printf 'rivulet: %s\n' "$*" >&2; }
to="$here/meshes/bunny.obj"
if [ -f "$to" ]; then
    say "$to is there already."
    exit 0
fi
for tool in npm node tar; do
    command -v "$tool" >/dev/null || { say "$tool is not installed: install it, or run the scene with --set colliders.0.mesh=YOUR.obj"; exit 1; }
done
folder="$(mktemp -d)"
trap 'rm -rf "$folder"' EXIT
if ! (cd "$folder" && npm pack --silent bunny@1.0.1 >/dev/null && tar xzf bunny-1.0.1.tgz); then
    say "the package bunny@1.0.1 could not be fetched from npm's registry: is there a network?"
    exit 1
fi
node -e '
const b = require(process.argv[1]);
const lines = ["# Stanford bunny, from the npm package bunny 1.0.1"];
for (const p of b.positions) lines.push("v " + p.join(" "));
for (const c of b.cells) lines.push("f " + c.map((i) => i + 1).join(" "));
require("fs").writeFileSync(process.argv[2], lines.join("\n") + "\n");
' "$folder/package/index.js" "$folder/bunny.obj" && mv "$folder/bunny.obj" "$to" || { say "bunny@1.0.1 is not what it was: nothing was written."; exit 1; }
say "wrote $to"

#!/usr/bin/env bash
# Loads every .gltf and .glb of two Debian packages of foreign models and prints a table of outcomes:
#   tests/scene/foreign_models.sh [RADIVOX [render]]        (apt-get install castle-game-engine-doc assimp-testmodels)
# Each is loaded and written anew (with "render" also drawn, small), or refused in one line; anything else is a failure, and so is a
# refusal of a file that is not known to be broken. Exit code: 0 as it should be, 1 not, 77 neither package is here.
set -uo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
radivox=${1:-$root/build/release/bin/radivox}
render=${2:-}
# glTF 1, extensions nobody implements, and files made to be wrong.
broken='/models/glTF/|/glTF2/(BoxTextured-glTF-techniqueWebGL|BoxWithInfinites-glTF-Binary|IndexOutOfRange|MissingBin|RecursiveNodes|SchemaFailures|wrongTypes)/|/TestNoRootNode/NoScene.gltf'

mapfile -t files < <(find /usr/share/doc/castle-game-engine-doc /usr/share/assimp/models -iname '*.gltf' -o -iname '*.glb' 2>/dev/null | LC_ALL=C sort)
if [[ ${#files[@]} -eq 0 ]]; then
  echo "neither castle-game-engine-doc nor assimp-testmodels is installed"
  exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
declare -A count=([loaded]=0 [refused]=0 [FAILED]=0)
for file in "${files[@]}"; do
  rm -f "$folder/out.glb"
  timeout 120 "$radivox" scene "$file" --out "$folder/out.glb" >"$folder/stdout" 2>"$folder/stderr"
  code=$?
  outcome=FAILED
  detail="exit code $code: $(tail -n 1 "$folder/stderr")"
  if [[ $code -eq 0 && -s $folder/out.glb ]]; then
    outcome=loaded
    detail="$(stat -c %s "$folder/out.glb") bytes, $(wc -l <"$folder/stderr") warnings"
    if [[ -n $render ]]; then
      rm -f "$folder/out.png"
      timeout 120 "$radivox" render "$file" --size 64x36 --set voxelize.resolution=32 --out "$folder/out.png" >"$folder/stdout" 2>"$folder/stderr"
      code=$?
      if [[ $code -ne 0 || ! -s $folder/out.png ]]; then
        outcome=FAILED
        detail="render: exit code $code: $(tail -n 1 "$folder/stderr")"
      fi
    fi
  elif [[ $code -eq 2 && $(wc -l <"$folder/stderr") -eq 1 && ! -e $folder/out.glb ]] && grep -qF "radivox: $file: " "$folder/stderr"; then
    detail=$(sed "s|^radivox: $file: ||" "$folder/stderr")
    if [[ $file =~ $broken ]]; then
      outcome=refused
    fi
  fi
  count[$outcome]=$((count[$outcome] + 1))
  printf '%-8s %s: %s\n' "$outcome" "${file#/usr/share/}" "$detail"
done
echo "${#files[@]} files: ${count[loaded]} loaded, ${count[refused]} refused, ${count[FAILED]} failed"
[[ ${count[FAILED]} -eq 0 ]]

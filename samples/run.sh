#!/usr/bin/env bash
# First picture: installs what is missing, builds, renders to out/ and writes the voxels there as VDB. A second run only renders.
#   samples/run.sh                                  the built-in atrium, and Sponza where it is found
#   samples/run.sh builtin:cornell path/to/a.glb    these scenes
# RADIVOX_SIZE=640x360 sets the size; RADIVOX_SHARED names a folder that holds scenes/sponza.glb.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
size=${RADIVOX_SIZE:-960x540}

scenes=()
for scene in "$@"; do
  case "$scene" in
    builtin:* | /*) scenes+=("$scene") ;;
    *) scenes+=("$PWD/$scene") ;; # the rest happens in the project's folder
  esac
done
shared=${RADIVOX_SHARED:-$root/../shared}
if [[ "$shared" != /* ]]; then
  shared="$PWD/$shared"
fi
cd "$root"
if [[ ${#scenes[@]} -eq 0 ]]; then
  scenes=(builtin:atrium)
  sponza="$shared/scenes/sponza.glb"
  if [[ -f "$sponza" ]]; then
    scenes+=("$sponza")
  fi
fi

third_party/install.sh
if [[ ! -f build/release/build.ninja ]]; then
  cmake --preset release
fi
cmake --build --preset release --target radivox_cli

mkdir -p out
for scene in "${scenes[@]}"; do
  name=${scene#builtin:}
  name=${name%%\?*}
  name=$(basename "$name")
  name=${name%.*}
  echo "rendering $scene at $size"
  build/release/bin/radivox render "$scene" --size "$size" --aov color,direct,indirect,albedo,normal,depth \
    --out "out/$name.exr" --out "out/$name.png" --stats "out/$name.json"
  # Without OpenVDB in this build there is no such file.
  if grep -q '^RADIVOX_VDB:BOOL=ON' build/release/CMakeCache.txt; then
    build/release/bin/radivox vdb "$scene" --grids voxels --out "out/$name.vdb"
  fi
  for file in "out/$name.png" "out/$name.exr" "out/$name.json" "out/$name.vdb"; do
    if [[ -f "$file" ]]; then
      echo "  $root/$file"
    fi
  done
done

#!/usr/bin/env bash
# A build without the optional parts: without_parts.sh WORK_FOLDER configures one and compiles what is written for it, every source that asks
# whether a part is there, with warnings as errors. third_party/README.md has the commands for the whole of it and its tests.
set -euo pipefail
work=$1
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache
fi
rm -rf "$work"
cmake -S "$source" -B "$work" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_FLAGS="-Werror -O0" -DRADIVOX_VDB=OFF -DRADIVOX_VIEWER=OFF \
  -DRADIVOX_REFERENCE=OFF -DRADIVOX_BUILD_TESTS=OFF >/dev/null
objects=(modules/CMakeFiles/radivox_modules.dir/register_modules.cpp.o)
while IFS= read -r file; do
  objects+=("$(cd "$work" && ninja -t targets all | grep -oE "^[^:]*/${file#samples/}\.o" | head -1)")
done < <(cd "$source" && grep -lE 'RADIVOX_WITH_(VDB|REFERENCE|WINDOW)' samples/*/*.cpp)
[[ ${#objects[@]} -gt 5 ]] || {
  echo "without_parts.sh: only ${objects[*]} ask what parts there are" >&2
  exit 1
}
cmake --build "$work" -j 2 --target "${objects[@]}"

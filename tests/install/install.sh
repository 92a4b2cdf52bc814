#!/usr/bin/env bash
# The installed package, as somebody else meets it: install.sh STEP BUILD_FOLDER WORK_FOLDER. Steps run in the order of the list below;
# the first clears WORK_FOLDER. Each fails with what it says.
set -euo pipefail
step=$1 build=$2 work=$3
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
prefix=$work/elsewhere
# ccache helps where it is there.
export CMAKE_GENERATOR=Ninja CMAKE_BUILD_PARALLEL_LEVEL=2
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache
fi
# Hosts' own instances get Khronos' layer with synchronization validation; a word of it fails a step.
export VK_INSTANCE_LAYERS=VK_LAYER_KHRONOS_validation VK_LAYER_ENABLES=VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT
scene=builtin:cornell_point size=80x60 settings=(--set voxelize.resolution=64)

fail() {
  echo "install.sh: $*" >&2
  exit 1
}

quietly() { # a command that fails shows what it said
  "$@" >"$work/log" 2>&1 || {
    tail -60 "$work/log" >&2
    fail "failed: $*"
  }
}

# expect TEXT COMMAND…: it ends well and prints TEXT; the layer says nothing.
expect() {
  local text=$1
  shift
  "$@" >"$work/log" 2>&1 || {
    cat "$work/log" >&2
    fail "failed: $*"
  }
  grep -qF -- "$text" "$work/log" || {
    cat "$work/log" >&2
    fail "no '$text' from: $*"
  }
  if grep -qiE 'validation|VUID|SYNC-HAZARD' "$work/log"; then
    cat "$work/log" >&2
    fail "validation messages from: $*"
  fi
}

# refuses WORDS CMAKE_ARGUMENT…: configuring a project that wants what is not there fails and says WORDS.
refuses() {
  local words=$1
  shift
  rm -rf "$work/refused"
  mkdir -p "$work/refused"
  cat >"$work/refused/CMakeLists.txt" <<'PROJECT'
cmake_minimum_required(VERSION 3.25)
project(refused LANGUAGES CXX)
find_package(radivox ${VERSION} REQUIRED COMPONENTS ${COMPONENT})
PROJECT
  if cmake -S "$work/refused" -B "$work/refused/build" "$@" >"$work/log" 2>&1; then
    fail "configured, though it should not: $*"
  fi
  # CMake breaks lines.
  tr -s ' \n' ' ' <"$work/log" | grep -qF -- "$words" || {
    cat "$work/log" >&2
    fail "no '$words' for: $*"
  }
}

# The same picture but for the last bits of its G-buffer's positions.
same() {
  cmp -s "$1" "$2" || "$prefix/bin/radivox" compare "$1" "$2" | awk '$1 == "psnr" { found = $2 > 100 } END { exit !found }'
}

case $step in
  package)
    rm -rf "$work"
    mkdir -p "$work"
    quietly cmake --install "$build" --prefix "$work/prefix"
    mv "$work/prefix" "$prefix" # relocatable
    if grep -rlF -e "$work" -e "$source" -e "$build" "$prefix/lib/cmake" "$prefix/include"; then
      fail "the files above name folders of this machine"
    fi
    expect "radivox 0." "$prefix/bin/radivox" --version
    ;;
  embed)
    quietly cmake -S "$source/samples/embed" -B "$work/embed" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_FLAGS=-Werror -DCMAKE_C_FLAGS=-Werror
    quietly cmake --build "$work/embed"
    expect "4 of 5 frames in the host's own command buffer" "$work/embed/embed" $scene "$work/embed.exr" $size
    quietly "$prefix/bin/radivox" render $scene --size $size --graph clustered_voxel "${settings[@]}" --out "$work/render.exr"
    same "$work/embed.exr" "$work/render.exr" || fail "samples/embed draws another picture than radivox render"
    ;;
  plugin)
    # A project of its own, as its reader has it.
    quietly cmake -S "$source/samples/embed/plugin" -B "$work/plugin" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_FLAGS=-Werror
    quietly cmake --build "$work/plugin"
    quietly cmake -S "$source/tests/install/consumer" -B "$work/consumer" -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_CXX_FLAGS=-Werror
    quietly cmake --build "$work/consumer"
    quietly "$prefix/bin/radivox" render $scene --size $size --graph clustered_voxel "${settings[@]}" --aov color,depth --out "$work/clear.exr"
    # In the host …
    expect "4 of 5 frames" "$work/embed/embed" $scene "$work/foggy.exr" $size "$work/plugin/fog.so"
    expect "node types" "$work/consumer/consumer" "$work/clear.exr" "$work/foggy.exr" 0.1 0.1
    # … and in the command, by a graph; one of few pipelines will do.
    sed -e 's/^  "nodes": {/&"fog": {"type": "sample.fog", "params": {"density": 0.2, "radiance": 0.3}},/' \
      -e 's/^  "edges": \[/&["composite.color", "fog.color"], ["gbuffer.position", "fog.position"],/' \
      -e 's/"color": "composite.color"/"color": "fog.color_in_fog"/' "$prefix/share/radivox/graphs/direct.json" >"$work/fog.json"
    quietly "$prefix/bin/radivox" render $scene --size $size --graph direct --aov color,depth --out "$work/clear.exr"
    quietly "$prefix/bin/radivox" render $scene --size $size --module "$work/plugin/fog.so" --graph "$work/fog.json" --out "$work/foggy.exr"
    expect "node types" "$work/consumer/consumer" "$work/clear.exr" "$work/foggy.exr" 0.2 0.3
    ;;
  c)
    expect "3 of 4 frames in the host's own command buffer" \
      "$work/embed/c/embed_c" $scene "$prefix/share/radivox/graphs/clustered_voxel.json" "$work/c.exr" $size
    same "$work/c.exr" "$work/embed.exr" || fail "samples/embed/c draws another picture than radivox render"
    # Alone, by pkg-less means: the header and the library are all it needs.
    quietly cc -std=c99 -pedantic-errors -Wall -Wextra -Werror -Wno-missing-field-initializers -I"$prefix/include/radivox" \
      "$source/samples/embed/c/embed.c" -o "$work/alone" -L"$prefix/lib" -lradivox -lvulkan -Wl,-rpath,"$prefix/lib"
    "$work/alone" $scene nowhere.json "$work/c.exr" >"$work/log" 2>&1 && fail "a graph file that is not there was read"
    grep -qF "nowhere.json" "$work/log" || fail "$(cat "$work/log")"
    # Only names of Radivox's own are seen from outside.
    if nm -D --defined-only "$prefix/lib/libradivox.so" | grep -vE ' (radivox[A-Z][A-Za-z]*|_Z(N|NK|TVN|TIN|TSN)7radivox.*)$' | head -5 | grep .; then
      fail "libradivox.so exports the names above"
    fi
    ;;
  components)
    refuses "there is no component no_such; there are engine, frame, clustered_voxel" -DCOMPONENT=no_such -DCMAKE_PREFIX_PATH="$prefix"
    refuses "compatible with requested version \"7.1\"" -DVERSION=7.1 -DCOMPONENT=engine -DCMAKE_PREFIX_PATH="$prefix"
    refuses "component engine is installed, but cannot be used; it needs the package glm" \
      -DCOMPONENT=engine -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_DISABLE_FIND_PACKAGE_glm=ON
    refuses "component frame is installed, but cannot be used; it needs the component engine; it needs the package OpenEXR" \
      -DCOMPONENT=frame -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_DISABLE_FIND_PACKAGE_OpenEXR=ON
    # A build without the optional parts says so.
    quietly cmake -S "$source" -B "$work/bare" -DCMAKE_BUILD_TYPE=Release -DRADIVOX_REFERENCE=OFF -DRADIVOX_BUILD_SAMPLES=OFF \
      -DRADIVOX_BUILD_TESTS=OFF
    rm -rf "$work/without"
    cp -r "$prefix" "$work/without"
    cp "$work/bare/package/radivoxConfig.cmake" "$work/without/lib/cmake/radivox/"
    refuses "component reference is not in this installation: it was built with RADIVOX_REFERENCE=OFF; install libembree-dev" \
      -DCOMPONENT=reference -DCMAKE_PREFIX_PATH="$work/without"
    refuses "component command is not in this installation: it was built with RADIVOX_BUILD_SAMPLES=OFF" \
      -DCOMPONENT=command -DCMAKE_PREFIX_PATH="$work/without"
    ;;
  *) fail "no step $step" ;;
esac

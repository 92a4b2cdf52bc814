#!/usr/bin/env bash
# What the documents tell a reader to type works: run_blocks.sh check DOCUMENT…, or run_blocks.sh run DOCUMENT BUILD_FOLDER WORK_FOLDER.
#
#   check  Every fenced block says what it is. ```sh is run; what is only to be read (a synopsis) is ```text; a command must not hide there
#          without its options in brackets. ```cpp after <!-- from: FILE --> stands in that file, line by line.
#   prove  (run_blocks.sh prove WORK_FOLDER) Documents that are wrong are found out.
#   run    All ```sh blocks of a document, in its order, by one shell in one folder that looks like the project's. The commands are as
#          printed, but pictures are made small and times short (the wrapper below). Nothing is installed on the machine.
#
# <!-- sh: left out: REASON --> above a block leaves it out; REASON must be one of those below.
set -euo pipefail
source=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
allowed_reasons=("it is what runs this test" "it builds from nothing" "a test of the command runs it")

fail() {
  echo "run_blocks.sh: $*" >&2
  exit 1
}

# blocks DOCUMENT: a line "LINE<tab>LANGUAGE<tab>MARK<tab>TEXT" for every line of every fenced block.
blocks() {
  awk '
    /^```/ { if (inside) { inside = 0 } else { inside = 1; language = substr($0, 4); if (language == "") language = "-"; printf "%d\t%s\t%s\t\n", NR, language, mark } mark = "-"; next }
    inside { printf "%d\t%s\t%s\t%s\n", NR, language, lastmark, $0; next }
    { if ($0 ~ /^<!-- /) { mark = $0 } else if ($0 != "") { mark = "-" } lastmark = mark }
    BEGIN { mark = "-"; lastmark = "-" }' "$1"
}

check() {
  local document bad=0
  for document in "$@"; do
    while IFS=$'\t' read -r line language mark text; do
      case $language in
        -) [[ $text =~ ^(\$ )?(radivox|cmake|ctest|ninja|git|bash|samples/|tests/|apt|sudo|export|PATH=) ]] && {
          echo "$document:$line: a command in a block without a language: label it sh, or text"
          bad=1
        } ;;
        text) [[ $text =~ ^(\$ )?(radivox|samples/|tests/) && $text != *[A-Z\[]* ]] && {
          echo "$document:$line: a whole command in a text block: label it sh"
          bad=1
        } ;;
        sh)
          if [[ $mark == '<!-- sh: left out: '* ]]; then
            local reason=${mark#'<!-- sh: left out: '}
            reason=${reason%' -->'}
            printf '%s\n' "${allowed_reasons[@]}" | grep -qxF -- "$reason" || {
              echo "$document:$line: left out for no allowed reason: $reason"
              bad=1
            }
          fi
          ;;
        cpp | cmake)
          if [[ $mark == '<!-- from: '* && -n $text ]]; then
            local file=${mark#'<!-- from: '}
            file=${file%' -->'}
            local trimmed=${text#"${text%%[![:space:]]*}"}
            grep -qF -- "$trimmed" "$source/$file" || {
              echo "$document:$line: no such line in $file: $trimmed"
              bad=1
            }
          fi
          ;;
      esac
    done < <(blocks "$document")
  done
  return $bad
}

wrap() { # the command, small and short
  cat <<'WRAPPER'
#!/usr/bin/env bash
arguments=() next=""
for argument in "$@"; do
  case $next in
    --size) [[ ${argument%%x*} -le 160 ]] || argument=64x36 ;;
    --spp) argument=2 ;;
    --time-limit) argument=2 ;;
    --max-error) argument=100 ;; # what so short a calibration can promise
    --set) [[ $argument != voxelize.resolution=* ]] || argument=voxelize.resolution=32 ;;
  esac
  next=$argument
  arguments+=("$argument")
done
has() { [[ " ${arguments[*]} " == *" $1 "* ]]; }
case ${1:-} in
  render | reference | report) has --size || arguments+=(--size 64x36) ;;
esac
case ${1:-} in
  render | vdb | moves) has --max-error || has --budget-ms || has --preset || has --set || arguments+=(--set voxelize.resolution=32) ;;
esac
# A window needs a display; what it shows does not.
[[ ${1:-} == view ]] && ! has --headless && arguments+=(--headless --out view.png --size 64x36 --set voxelize.resolution=32)
[[ ${1:-} == stability ]] && arguments+=(--case "plates 0.01 voxels apart, lit" --method clustered_voxel)
[[ ${1:-} == needs ]] && arguments=(needs builtin:plane --runs 1 --size 64x36)
[[ ${1:-} == bench ]] && arguments+=(--rays 10000 --runs 1 --set voxelize.resolution=32)
[[ ${1:-} == reference ]] && { has --spp || arguments+=(--spp 2); }
[[ ${1:-} == render ]] && { has --max-error || has --budget-ms; } && arguments+=(--calibration-time 2)
[[ ${1:-} == render ]] && ! has --max-error && ! has --budget-ms && ! has --graph && ! has voxelize.resolution=64 &&
  arguments+=(--set voxelize.resolution=32)
exec "$RADIVOX_BINARY" "${arguments[@]}"
WRAPPER
}

run() {
  local document=$1 build=$2 work=$3
  rm -rf "$work"
  mkdir -p "$work/project/build" "$work/bin"
  local entry
  for entry in "$source"/*; do
    case $(basename "$entry") in
      build | out) ;;
      *) ln -s "$entry" "$work/project/" ;;
    esac
  done
  ln -s "$build" "$work/project/build/release"
  # What the document prints as files (<!-- file: PATH -->) is there, as its reader has written it.
  blocks "$document" | while IFS=$'\t' read -r line language mark text; do
    [[ $mark == '<!-- file: '*/* ]] || continue
    local file=${mark#'<!-- file: '}
    file=$work/project/${file%' -->'}
    mkdir -p "$(dirname "$file")"
    echo "$text" >>"$file"
  done
  wrap >"$work/bin/radivox"
  chmod +x "$work/bin/radivox"
  {
    echo 'set -euo pipefail; PS4="+ \${SECONDS}s "; set -x'
    echo "trap 'echo \"$document: line \$LINE fails\" >&2' ERR"
    blocks "$document" | while IFS=$'\t' read -r line language mark text; do
      if [[ $language == sh && $mark != '<!-- sh: left out'* && -n $text ]]; then
        # A command that goes on in the next line keeps its first line's number.
        if [[ ${continues:-} != 1 ]]; then echo "LINE=$line"; fi
        echo "$text"
        continues=0
        if [[ $text == *\\ ]]; then continues=1; fi
      fi
    done
  } >"$work/commands.sh"
  export RADIVOX_BINARY=$build/bin/radivox RADIVOX_SKIP_INSTALL=1 RADIVOX_SIZE=64x36 RADIVOX_SHARED=$work/nowhere
  export PATH=$work/bin:$PATH CMAKE_GENERATOR=Ninja CMAKE_BUILD_PARALLEL_LEVEL=2
  if command -v ccache >/dev/null; then
    export CMAKE_CXX_COMPILER_LAUNCHER=ccache CMAKE_C_COMPILER_LAUNCHER=ccache
  fi
  cd "$work/project"
  bash "$work/commands.sh" || fail "$document: what it tells to type does not work (above)"
}

prove() {
  local work=$1 self=$source/tests/docs/run_blocks.sh name
  rm -rf "$work"
  mkdir -p "$work/bin"
  cd "$work"
  printf '```\nradivox info\n```\n' >unlabelled.md
  printf '```text\nradivox info\n```\n' >hidden.md
  printf '<!-- sh: left out: no time -->\n```sh\nfalse\n```\n' >excused.md
  printf '<!-- from: samples/embed/gi.cpp -->\n```cpp\n  int notThere = 3;\n```\n' >stale.md
  for name in unlabelled hidden excused stale; do
    "$self" check "$name.md" >log && fail "$name.md was accepted"
    grep -q "^$name.md:" log || fail "$name.md: its place is not named: $(cat log)"
  done
  printf 'text\n\n```sh\necho one > file\n```\n\n<!-- sh: left out: it is what runs this test -->\n```sh\nfalse\n```\n' >right.md
  "$self" check right.md || fail "right.md was refused"
  "$self" run "$work/right.md" "$work" "$work/run" 2>/dev/null || fail "right.md failed"
  [[ $(cat run/project/file) == one ]] || fail "right.md was not run"
  printf '```sh\ntrue\nfalse # fails\n```\n' >wrong.md
  "$self" run "$work/wrong.md" "$work" "$work/run" 2>log && fail "wrong.md passed"
  grep -q "wrong.md: line 3 fails" log || fail "wrong.md: its line is not named: $(cat log)"
}

"$@"

#!/usr/bin/env bash
# Installs the packages of packages.txt that are missing, as root or through sudo. Does nothing, and asks for nothing, when all are there.
# RADIVOX_SKIP_INSTALL=1 leaves the machine as it is.
set -euo pipefail
folder=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)

if [[ "${RADIVOX_SKIP_INSTALL:-0}" == 1 ]]; then
  exit 0
fi
mapfile -t packages < <(sed -e 's/#.*//' -e 's/[[:space:]]*$//' -e '/^$/d' "$folder/packages.txt")
if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
  echo "install.sh: this is no Debian; install what these packages hold, then run again with RADIVOX_SKIP_INSTALL=1:" >&2
  echo "  ${packages[*]}" >&2
  exit 1
fi
missing=()
for package in "${packages[@]}"; do
  if [[ "$(dpkg-query -W -f='${Status}' "$package" 2>/dev/null || true)" != "install ok installed" ]]; then
    missing+=("$package")
  fi
done
if [[ ${#missing[@]} -eq 0 ]]; then
  exit 0
fi

echo "install.sh: installing ${missing[*]}"
administrator=()
if [[ $(id -u) -ne 0 ]]; then
  if command -v sudo >/dev/null; then
    administrator=(sudo)
    if [[ ! -t 0 ]]; then
      administrator=(sudo -n) # nobody is there to type a password
    fi
  else
    echo "install.sh: packages are missing and this is neither root nor is sudo there; as root, run: apt-get install ${missing[*]}" >&2
    exit 1
  fi
fi
apt=("${administrator[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -y)
# Old lists may still do where the update fails.
"${apt[@]}" update || echo "install.sh: apt-get update failed; trying with the lists there are" >&2
if ! "${apt[@]}" install --no-install-recommends "${missing[@]}"; then
  echo "install.sh: could not install; as root, run: apt-get update && apt-get install ${missing[*]}" >&2
  exit 1
fi

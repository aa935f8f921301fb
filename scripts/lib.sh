# Sourced by the scripts, never run.
# shellcheck shell=bash
set -euo pipefail

script="$(realpath "$0")"
root="$(dirname "$(dirname "$script")")"  # the top of the repository, wherever the script is called from
cd "$root"

# Prints the comment that opens the calling script: its help text.
usage() { sed -n '2,${/^#/!q; s/^# \{0,1\}//p}' "$script"; }

# refuse WORD: bad usage, exit 2.
refuse() {
  echo "${script##*/}: $1 is not an argument of it; see scripts/${script##*/} --help" >&2
  exit 2
}

# Sourced by the scripts that spread a run over machines, never run: arguments, the command of a shard, and the merge.
# shellcheck shell=bash disable=SC2154

# die WORDS...: bad usage, exit 2.
die() {
  echo "${script##*/}: $*" >&2
  exit 2
}

# take_arguments COUNT OUT RUN-ARGUMENT...: sets count, out, parts and run, and sees that the run's arguments are good.
take_arguments() {
  (($# >= 3)) || die "COUNT, OUT and the arguments of gnomon run are wanted; see scripts/${script##*/} --help"
  count=$1 out=${2%/}
  shift 2
  run=("$@")
  [[ $count =~ ^[1-9][0-9]{0,3}$ ]] || die "COUNT = $count is not a whole number of 1 .. 9999"
  # What the shards are of: all words but those that only say what to do with rows that are there.
  local word rows=() arguments
  for word in "${run[@]}"; do
    [[ $word == --retry-failed ]] || rows+=("$word")
    case "$word" in
      --shard | --shard=* | --out | --out=* | --resume | --dry-run) die "$word is for this script to say, not for you" ;;
    esac
  done
  program=${GNOMON_PROGRAM:-build/release/gnomon}
  [[ -x $program ]] || die "$program is not there: build it first (scripts/run)"
  [[ ! -e $out ]] || die "output folder $out is there already: name another one"
  parts=$out.parts
  "$program" run "${rows[@]}" --dry-run | tail -n 2 >&2 || exit 2
  mkdir -p "$parts"
  # Another number of shards would deal the rows out anew, and rows of both would be run twice.
  [[ ! -e $parts/count || $(<"$parts/count") == "$count" ]] ||
    die "$parts holds shards of a run in $(<"$parts/count") parts: continue with that COUNT, or remove it"
  # Other arguments would run other rows, and what the shards hold of the first ones would be merged with them.
  arguments=$(printf '%q ' "${rows[@]}")
  arguments=${arguments% }
  [[ ! -e $parts/arguments || $(<"$parts/arguments") == "$arguments" ]] ||
    die "$parts holds shards of 'gnomon run $(<"$parts/arguments")': continue with these arguments, or remove it"
  echo "$count" >"$parts/count"
  echo "$arguments" >"$parts/arguments"
  rm -f "$parts"/*.status
}

# shard_command I: one line for a shell on any machine that sees this folder. I may be a variable of that shell. A shard that was
# stopped is continued; its exit status is left in a file, because no two engines report it alike.
shard_command() {
  local words environment=() name
  for name in GNOMON_CACHE GNOMON_ROOT; do
    [[ -z ${!name-} ]] || environment+=("$name=${!name}")
  done
  words=$(printf '%q ' cd "$root")"&& "
  words+=$(printf '%q ' env "${environment[@]}" "$program" run "${run[@]}" --resume)
  words+="--shard $1/$count --out $(printf '%q' "$parts")/$1 >$(printf '%q' "$parts")/$1.out"
  echo "$words; echo \$? >$(printf '%q' "$parts")/$1.status"
}

# Sees that all shards are done, merges them and removes their folders: all that they held is in the merged one. Exit status of
# `gnomon merge`: 1 when a row failed. Nothing is merged, and everything stays, when a shard was stopped or refused.
finish() {
  local k folders=() unfinished=0 state=0
  for ((k = 0; k < count; ++k)); do
    folders+=("$parts/$k")
    case "$(cat "$parts/$k.status" 2>/dev/null)" in
      0 | 1) ;;
      "") unfinished=$((unfinished + 1)) && echo "shard $k/$count was stopped" >&2 ;;
      *) unfinished=$((unfinished + 1)) && echo "shard $k/$count ended with status $(<"$parts/$k.status")" >&2 ;;
    esac
  done
  if ((unfinished)); then
    echo "$unfinished of $count shards are not done; call this again to continue them ($parts)" >&2
    return 1
  fi
  "$program" merge "${folders[@]}" --out "$out" || state=$?
  [[ ! -e $out/records.jsonl ]] || rm -r "$parts"
  return "$state"
}

#!/usr/bin/env bash
# completion.sh FILE: what bash offers after some beginnings of a line.
set -euo pipefail
. "$1"
offered() {
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  _heartgen
  echo " ${COMPREPLY[*]} "
}
expect() {  # expect "words that are offered" beginning...
  local wanted=$1
  shift
  for word in $wanted; do
    [[ "$(offered "$@")" == *" $word "* ]] || { echo "no $word after: $*: $(offered "$@")"; exit 1; }
  done
}
expect "build export improve" heartgen ""
expect "validate verify" heartgen v
expect "--ct --atlas --threads" heartgen build --
expect "--ct" heartgen build --output out --c
[[ -z "$(offered heartgen build pat | tr -d ' ')" ]] || { echo "files are bash's own business"; exit 1; }

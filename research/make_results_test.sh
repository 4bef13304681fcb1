#!/usr/bin/env bash
# research/make-results.sh in a tree of its own, with programs that print a line:
# what it writes, what it leaves alone, and what an interruption leaves behind.
set -euo pipefail
source_dir=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
cd "$tree"

mkdir -p build/release/bin server/registry research/{paper,upper} \
  examples/recordings
cp "$source_dir/research/make-results.sh" research
touch research/a.py server/registry/a.tactus research/{paper,upper}/a.py \
  examples/recordings/a.py
# build WORD: programs that print WORD and their command.
build() {
  for program in trainctl tactus-bench world-signals paper-hmms; do
    # shellcheck disable=SC2016
    printf '#!/bin/sh\n[ ! -e %s/broken ] || exit 1\necho %s "$@", 1.5 s\n' "$tree" "$1" \
      >"build/release/bin/$program"
    chmod +x "build/release/bin/$program"
  done
}
fail() {
  echo "make_results_test: $1" >&2
  cat log >&2
  exit 1
}
run() { research/make-results.sh "$@" >log 2>&1; }
says() { grep -q "$1" log || fail "does not say: $1"; }

# Only grid and taxels need no other program.
sed -i '/^all_pages=(/,/)$/c all_pages=(grid taxels)' research/make-results.sh
grep -q '^all_pages=(grid taxels)$' research/make-results.sh || fail "the list of pages has another form"

build first
run || fail "the first run fails"
says 'grid: written in [0-9]* s$'
says '2 of 2 pages written in [0-9]* s$'
head=$(sed -n 3p research/results/grid.md)
grep -q '^Skin: none, ideal signals\. Seeds: .*7 (test).* Of: the 2,000 contacts' <<<"$head" ||
  fail "the third line is no head: $head"
grep -q '^first evaluate --data=grid.h5 --model=signals.tactus$' research/results/grid.md ||
  fail "the page lacks what was printed"

run || fail "the second run fails"
says 'grid: left alone'
says '0 of 2 pages written'

# Of another build; interrupted between the pages and within one.
build second
run grid || fail "a named page fails"
touch broken
cp research/results/taxels.md before
! run || fail "an error is no error"
says 'grid: left alone'
says 'taxels: not completed'
cmp -s before research/results/taxels.md || fail "half a page is left behind"
rm broken
run || fail "the run does not go on"
says 'grid: left alone'
says '1 of 2 pages written'
grep -q '^second ' research/results/taxels.md || fail "the page is not of the second build"

# Named pages are written, lost ones and those of other scripts too.
run taxels || fail "a named page fails"
says '1 of 1 pages written'
rm research/results/grid.md
echo '# changed' >>research/a.py
run || fail "a lost page is not written"
says '2 of 2 pages written'
# A page of data that only some have.
! run eflesh || fail "takes data that there are not"
says "TACTUS_EFLESH_DIR is ''"
! run nonsense || fail "takes a page that there is not"
says "unknown page 'nonsense'"

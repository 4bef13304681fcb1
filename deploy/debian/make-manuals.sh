#!/bin/sh
# Writes the manual pages of the programs in a folder, from their --help.
#
#   make-manuals.sh PROGRAMS OUT
set -eu
mkdir -p "$2"

# page NAME SECTION TEXT [OPTIONS]
page() {
  program=$1 section=$2 text=$3
  shift 3
  help2man --no-info --section="$section" --name="$text" \
    --source=Tactus --output="$out/$program.$section" "$@" "$programs/$program"
}

programs=$1 out=$2
page tactusd 8 "server that tells a robot what its skin touches"
page tactus-worker 8 "runs trainings and evaluations of Tactus servers"
# It has no --version.
version=$("$programs/tactusd" --version)
page tactus-trainer 8 "runs one job of tactusd, which starts it" \
  --version-string="tactus-trainer ${version#* }"
if [ -e "$programs/tactus-trainer-mpi" ]; then
  # One rank of the same job.
  echo ".so man8/tactus-trainer.8" >"$out/tactus-trainer-mpi.8"
fi
page trainctl 1 "train models of contacts, and manage Tactus servers"
page tactus-stream 1 "stream contacts to a Tactus server as a robot would"
page tactus-load 1 "load a Tactus server with many robots"
page tactus-fakeskin 1 "play the boards of a robot's skin"
page tactus-ros2 1 "publish on topics of ROS 2 what a robot's skin touches"
page tactus-console 1 "show what robots feel, in a browser"

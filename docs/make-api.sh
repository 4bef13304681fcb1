#!/usr/bin/env bash
# Writes the reference of the C++ interface (docs/api.md) as HTML pages, from the
# comments of the installed headers. Fails at the first thing that doxygen warns
# of, such as a name that is not there.
#
#   docs/make-api.sh FOLDER       FOLDER/html/index.html is the first page
#
# Needs Debian's doxygen.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

if [[ $# -ne 1 ]]; then
  echo "usage: docs/make-api.sh FOLDER" >&2
  exit 2
fi
mkdir -p "$1"
folder=$(realpath "$1")
doxygen - <<DOXYFILE
PROJECT_NAME = Tactus
OUTPUT_DIRECTORY = "$folder"
INPUT = client/include/tactus docs/api.md
USE_MDFILE_AS_MAINPAGE = docs/api.md
INPUT_FILTER = "sed -E -f docs/api-comments.sed"
STRIP_FROM_PATH = client/include
STRIP_FROM_INC_PATH = client/include
EXTRACT_ALL = YES
FULL_PATH_NAMES = YES
GENERATE_LATEX = NO
HAVE_DOT = NO
JAVADOC_AUTOBRIEF = YES
QUIET = YES
WARN_AS_ERROR = FAIL_ON_WARNINGS
DOXYFILE

#!/usr/bin/env bash
# Exchanges models with the other programs themselves: PyTorch, numpy, ONNX
# Runtime, pomegranate and OpenCV. The quick test, interchange_test, has their recorded
# answers; this script makes new ones and fails where a figure is beyond its
# tolerance.
#
#   tests/core/interchange/check.sh            needs build/release
#   tests/core/interchange/check.sh --record   also replaces
#                                              tests/golden/interchange
#
# Needs Debian's python3-torch, python3-onnx, python3-h5py, python3-pomegranate,
# python3-opencv, nodejs and npm. Fetches npm's onnxruntime-node (290 MB) to a
# temporary folder unless NODE_PATH holds it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../../.."

readonly HERE=tests/core/interchange
readonly GOLDEN=tests/golden/interchange
samples=build/release/tests/interchange_samples
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if [[ ! -d ${NODE_PATH-}/onnxruntime-node ]]; then
  (cd "$work" && npm install --ignore-scripts --no-audit --no-fund \
    --prefix "$work/npm" onnxruntime-node@1)
  export NODE_PATH=$work/npm/node_modules
fi

mkdir "$work/files" "$work/bundle"
"$samples" write "$work/files"
"$samples" write "$work/bundle" server/registry/default.tactus
for folder in "$work/files" "$work/bundle"; do
  echo "== $(basename "$folder")"
  node "$HERE/onnxruntime.mjs" "$folder"
  /usr/bin/python3 "$HERE/peers.py" hmm "$folder"
  # Without the library's own lines on what it does not load.
  /usr/bin/python3 "$HERE/peers.py" opencv "$folder" 2>/dev/null
done
/usr/bin/python3 "$HERE/peers.py" make "$work/files"
/usr/bin/python3 "$HERE/numpy_stacks.py" "$work/files"
"$samples" read "$work/files"

if [[ ${1-} == --record ]]; then
  rm -rf "$GOLDEN"
  mkdir -p "$GOLDEN"
  # The quick test makes these itself.
  rm "$work"/files/{networks,hmm-scores,hmms-ghmm}.json
  cp "$work"/files/* "$GOLDEN/"
  ls -l "$GOLDEN"
fi

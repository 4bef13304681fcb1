#include "core/trees/trees.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

absl::Status Wrong(absl::string_view what, size_t node, double got,
                   absl::string_view want) {
  return InvalidModel(absl::StrCat(what, " of tree node ", node), got, want);
}

// Every way from a root goes forwards, within its tree, to a leaf.
absl::Status CheckNode(const Trees& trees, size_t node, size_t end) {
  const int32_t number = trees.number[node];
  if (number < 0) {
    if (-1 - int64_t{number} < trees.classes) return absl::OkStatus();
    return Wrong("class", node, -1.0 - number,
                 absl::StrCat("below ", trees.classes));
  }
  if (static_cast<size_t>(number) >= trees.history.numbers()) {
    return Wrong("number", node, number,
                 absl::StrCat("below ", trees.history.numbers()));
  }
  if (!std::isfinite(trees.threshold[node])) {
    return Wrong("threshold", node, trees.threshold[node], "finite");
  }
  const size_t child = trees.child[node];
  if (child <= node || child + 1 >= end) {
    return Wrong("child", node, static_cast<double>(child),
                 absl::StrCat(node + 1, " to ", end - 2));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const Trees& trees) {
  TACTUS_RETURN_IF_ERROR(Validate(trees.history));
  const size_t nodes = trees.number.size();
  if (trees.history.has_kernels() || nodes > kMostTreeNodes ||
      trees.threshold.size() != nodes || trees.child.size() != nodes) {
    return InvalidModel(
        "nodes of the trees",
        absl::StrCat(nodes, " numbers, ", trees.threshold.size(),
                     " thresholds and ", trees.child.size(), " children"),
        absl::StrCat("as many of each, at most ", kMostTreeNodes,
                     ", without kernels"));
  }
  if (trees.root.empty() || trees.root.front() != 0) {
    return InvalidModel("roots of the trees", trees.root.size(),
                        "at least one, the first of them 0");
  }
  for (size_t t = 0; t < trees.root.size(); ++t) {
    const size_t begin = trees.root[t];
    const size_t end = t + 1 < trees.root.size() ? trees.root[t + 1] : nodes;
    if (begin >= end || end > nodes) {
      return InvalidModel("root of a tree", begin,
                          absl::StrCat("below the next one and ", nodes));
    }
    for (size_t node = begin; node < end; ++node) {
      TACTUS_RETURN_IF_ERROR(CheckNode(trees, node, end));
    }
  }
  return absl::OkStatus();
}

TreesScorer::TreesScorer(const Trees* trees)
    : trees_(trees),
      history_(&trees->history),
      numbers_(trees->history.numbers()) {}

void TreesScorer::Score(std::span<double> scores) {
  history_.Write(numbers_);
  std::ranges::fill(scores, 0.0);
  const Trees& trees = *trees_;
  for (size_t node : trees.root) {
    while (trees.number[node] >= 0) {
      const bool below = numbers_[trees.number[node]] < trees.threshold[node];
      node = trees.child[node] + (below ? 0 : 1);
    }
    scores[-1 - trees.number[node]] += 1;
  }
  const double per_tree = 1 / static_cast<double>(trees.root.size());
  for (double& score : scores) score *= per_tree;
}

}  // namespace tactus::internal

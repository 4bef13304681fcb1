#include "core/interchange/lstm/onnx_axes.h"

#include <algorithm>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"
#include "core/interchange/lstm/onnx_tensor.h"

namespace tactus::internal {
namespace {

constexpr char kTime = 'T';
constexpr char kFeatures = 'F';
constexpr char kOne = '1';
constexpr size_t kMaxAxes = 8;

using Integers = std::vector<int64_t>;

// The whole numbers of a stored tensor.
absl::StatusOr<Integers> IntegersOf(const OnnxNode& node,
                                    const OnnxTensors& tensors, size_t index,
                                    const char* name) {
  if (index >= tensors.size() || tensors[index] == nullptr) {
    return node.Invalid(absl::StrCat(
        "has ", name,
        " that the graph computes; export with constants folded and without "
        "dynamic axes but time"));
  }
  TACTUS_ASSIGN_OR_RETURN(const OnnxNumbers numbers,
                          NumbersOf(*tensors[index]));
  Integers integers;
  for (const double value : numbers.values) {
    integers.push_back(static_cast<int64_t>(std::clamp(value, -1e9, 1e9)));
  }
  return integers;
}

// Axes from an attribute, as opsets below 13 have them, or from input 1. Empty
// if neither is there.
absl::StatusOr<Integers> AxesOf(const OnnxNode& node,
                                const OnnxTensors& tensors) {
  if (node.Find("axes") != nullptr) return node.Ints("axes");
  if (node.input(1).empty()) return Integers();
  return IntegersOf(node, tensors, 0, "axes");
}

// `axis` counted from the front, or an error.
absl::StatusOr<size_t> FromFront(const OnnxNode& node, int64_t axis,
                                 size_t rank) {
  const int64_t size = static_cast<int64_t>(rank);
  if (axis < -size || axis >= size) {
    return node.Invalid(absl::StrCat("names axis ", axis, " of ", rank));
  }
  return static_cast<size_t>(axis < 0 ? axis + size : axis);
}

absl::Status Squeeze(const OnnxNode& node, const OnnxTensors& tensors,
                     OnnxData* data) {
  TACTUS_ASSIGN_OR_RETURN(const Integers axes, AxesOf(node, tensors));
  std::string marked = data->axes;
  const std::string removable =
      data->one_step ? std::string{kOne, kTime} : std::string{kOne};
  for (const int64_t axis : axes) {
    TACTUS_ASSIGN_OR_RETURN(const size_t i,
                            FromFront(node, axis, marked.size()));
    if (removable.find(data->axes[i]) == std::string::npos) {
      return node.Invalid(
          "removes the axis of time or of features; it may remove axes of one "
          "entry");
    }
    marked[i] = ' ';
  }
  if (axes.empty()) std::replace(marked.begin(), marked.end(), kOne, ' ');
  std::erase(marked, ' ');
  data->axes = marked;
  return absl::OkStatus();
}

absl::Status Unsqueeze(const OnnxNode& node, const OnnxTensors& tensors,
                       OnnxData* data) {
  TACTUS_ASSIGN_OR_RETURN(Integers axes, AxesOf(node, tensors));
  const size_t rank = data->axes.size() + axes.size();
  if (rank > kMaxAxes) {
    return node.Invalid(
        absl::StrCat("makes ", rank, " axes; at most ", kMaxAxes, " are read"));
  }
  std::string result(rank, ' ');
  for (const int64_t axis : axes) {
    TACTUS_ASSIGN_OR_RETURN(const size_t i, FromFront(node, axis, rank));
    if (result[i] == kOne) return node.Invalid("adds an axis twice");
    result[i] = kOne;
  }
  auto next = data->axes.begin();
  for (char& label : result) {
    if (label == ' ') label = *next++;
  }
  data->axes = result;
  return absl::OkStatus();
}

absl::Status Transpose(const OnnxNode& node, OnnxData* data) {
  const std::string& axes = data->axes;
  std::string result(axes.rbegin(), axes.rend());
  if (node.Find("perm") != nullptr) {
    const Integers perm = node.Ints("perm");
    if (perm.size() != axes.size()) {
      return node.Invalid("has a perm of another length");
    }
    for (size_t i = 0; i < perm.size(); ++i) {
      if (std::count(perm.begin(), perm.end(), static_cast<int64_t>(i)) != 1) {
        return node.Invalid("has a perm that is no permutation");
      }
      result[i] = axes[static_cast<size_t>(perm[i])];
    }
  }
  data->axes = result;
  return absl::OkStatus();
}

// Keeps the last axis, that of features, and the order of frames.
absl::Status Reshape(const OnnxNode& node, const OnnxTensors& tensors,
                     int64_t width, OnnxData* data) {
  TACTUS_ASSIGN_OR_RETURN(const Integers shape,
                          IntegersOf(node, tensors, 0, "a shape"));
  const std::string& axes = data->axes;
  const bool has_time = axes.find(kTime) != std::string::npos;
  std::string result;
  bool fits = !shape.empty() && shape.size() <= kMaxAxes && !axes.empty() &&
              axes.back() == kFeatures;
  for (size_t i = 0; fits && i + 1 < shape.size(); ++i) {
    char label = kOne;
    if (shape[i] == 0) {
      label = i + 1 < axes.size() ? axes[i] : kFeatures;
    } else if (shape[i] != 1) {
      // All frames, as one batch has no other axis of more than one entry.
      label = has_time ? kTime : kFeatures;
    }
    fits = label == kOne ||
           (label == kTime && result.find(kTime) == std::string::npos);
    result += label;
  }
  const bool keeps_time =
      !has_time || data->one_step || result.find(kTime) != std::string::npos;
  if (!fits || !keeps_time ||
      (shape.back() != width && shape.back() != -1 &&
       !(shape.back() == 0 && shape.size() == axes.size()))) {
    return node.Invalid("mixes features with other axes");
  }
  data->axes = result + kFeatures;
  return absl::OkStatus();
}

// Takes entry `index` of an axis: the last frame, or the only entry.
absl::Status CheckTaken(const OnnxNode& node, char label, int64_t index) {
  if (label == kTime && index == -1) return absl::OkStatus();
  if (label == kOne && (index == 0 || index == -1)) return absl::OkStatus();
  return node.Invalid(absl::StrCat(
      "takes entry ", index,
      label == kTime ? " of the frames; only the last, -1, may be taken"
                     : " of an axis that must be kept"));
}

absl::Status Gather(const OnnxNode& node, const OnnxTensors& tensors,
                    OnnxData* data) {
  TACTUS_ASSIGN_OR_RETURN(const Integers index,
                          IntegersOf(node, tensors, 0, "indices"));
  TACTUS_ASSIGN_OR_RETURN(
      const size_t axis,
      FromFront(node, node.Int("axis", 0), data->axes.size()));
  if (index.size() != 1) {
    return node.Invalid("takes several entries of an axis");
  }
  TACTUS_RETURN_IF_ERROR(CheckTaken(node, data->axes[axis], index[0]));
  if (tensors[0]->dims_size() == 0) {
    data->axes.erase(axis, 1);
  } else {
    data->axes[axis] = kOne;
  }
  return absl::OkStatus();
}

absl::Status Slice(const OnnxNode& node, const OnnxTensors& tensors,
                   OnnxData* data) {
  // Below opset 10 they are attributes.
  Integers starts = node.Ints("starts");
  Integers axes = node.Ints("axes");
  if (node.Find("starts") == nullptr) {
    TACTUS_ASSIGN_OR_RETURN(starts, IntegersOf(node, tensors, 0, "starts"));
    TACTUS_ASSIGN_OR_RETURN(axes, IntegersOf(node, tensors, 2, "axes"));
  }
  if (starts.size() != 1 || axes.size() != 1) {
    return node.Invalid("slices several axes");
  }
  TACTUS_ASSIGN_OR_RETURN(const size_t axis,
                          FromFront(node, axes[0], data->axes.size()));
  TACTUS_RETURN_IF_ERROR(CheckTaken(node, data->axes[axis], starts[0]));
  data->axes[axis] = kOne;
  return absl::OkStatus();
}

}  // namespace

bool MovesAxes(const OnnxNode& node) {
  for (const char* type :
       {"Squeeze", "Unsqueeze", "Transpose", "Reshape", "Gather", "Slice"}) {
    if (node.type() == type) return true;
  }
  return false;
}

absl::Status MoveAxes(const OnnxNode& node, const OnnxTensors& tensors,
                      OnnxData* data) {
  if (node.type() == "Squeeze") return Squeeze(node, tensors, data);
  if (node.type() == "Unsqueeze") return Unsqueeze(node, tensors, data);
  if (node.type() == "Transpose") return Transpose(node, data);
  if (node.type() == "Gather") return Gather(node, tensors, data);
  if (node.type() == "Slice") return Slice(node, tensors, data);
  return Reshape(node, tensors, data->stack->width(), data);
}

}  // namespace tactus::internal

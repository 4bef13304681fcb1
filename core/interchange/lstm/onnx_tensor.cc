#include "core/interchange/lstm/onnx_tensor.h"

#include <bit>
#include <cstring>
#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/text.h"
#include "core/interchange/lstm/onnx_names.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "raw_data is little-endian");

template <typename Number>
bool TakeRaw(const std::string& raw, size_t count,
             std::vector<double>* values) {
  if (raw.size() != count * sizeof(Number)) return false;
  for (size_t i = 0; i < count; ++i) {
    Number value;
    std::memcpy(&value, raw.data() + i * sizeof(Number), sizeof value);
    values->push_back(static_cast<double>(value));
  }
  return true;
}

template <typename Field>
bool TakeList(const Field& list, size_t count, std::vector<double>* values) {
  if (static_cast<size_t>(list.size()) != count) return false;
  values->assign(list.begin(), list.end());
  return true;
}

}  // namespace

absl::StatusOr<OnnxNumbers> NumbersOf(const onnx::TensorProto& tensor) {
  const std::string what = absl::StrCat("tensor ", Quoted(tensor.name()));
  if (tensor.data_location() != 0 || tensor.external_data_size() > 0) {
    return InvalidModel(what, "in another file",
                        "in this one: save the model without external data");
  }
  OnnxNumbers out;
  size_t count = 1;
  for (const int64_t size : tensor.dims()) {
    if (size < 0 || static_cast<uint64_t>(size) > limits::kMaxBundleBytes ||
        (count *= static_cast<size_t>(size)) > limits::kMaxBundleBytes) {
      return InvalidModel(
          absl::StrCat(what, " size"), size,
          absl::StrCat("at most ", limits::kMaxBundleBytes, " numbers in all"));
    }
    out.shape.push_back(static_cast<size_t>(size));
  }
  const bool raw = tensor.has_raw_data();
  bool fits = false;
  switch (tensor.data_type()) {
    case kOnnxFloat:
      fits = raw ? TakeRaw<float>(tensor.raw_data(), count, &out.values)
                 : TakeList(tensor.float_data(), count, &out.values);
      break;
    case kOnnxDouble:
      fits = raw ? TakeRaw<double>(tensor.raw_data(), count, &out.values)
                 : TakeList(tensor.double_data(), count, &out.values);
      break;
    case kOnnxInt64:
      fits = raw ? TakeRaw<int64_t>(tensor.raw_data(), count, &out.values)
                 : TakeList(tensor.int64_data(), count, &out.values);
      break;
    default:
      return InvalidModel(absl::StrCat(what, " type"), tensor.data_type(),
                          "1 (float), 11 (double) or 7 (int64)");
  }
  if (!fits) {
    return InvalidModel(what, "cut short or too long",
                        absl::StrCat("of ", count, " numbers, as its shape"));
  }
  return out;
}

}  // namespace tactus::internal

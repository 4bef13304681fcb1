#include "core/interchange/read_model_file.h"

#include <array>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "core/base/limits.h"
#include "core/files/file_bytes.h"
#include "core/interchange/hmm/hmm_json.h"
#include "core/interchange/hmm/hmm_npz.h"
#include "core/interchange/lstm/lstm_from_onnx.h"
#include "core/interchange/model/model_file_error.h"

namespace tactus::internal {
namespace {

// Pickles, and archives that hold them (.pt, .pth).
constexpr std::array<absl::string_view, 6> kPickles = {
    ".pkl", ".pickle", ".joblib", ".pt", ".pth", ".ckpt"};

}  // namespace

absl::StatusOr<ForeignModel> ReadModelFile(const std::string& path,
                                           const KerasOptions& keras) {
  const std::string name = absl::AsciiStrToLower(path);
  for (const absl::string_view ending : kPickles) {
    if (!absl::EndsWith(name, ending)) continue;
    return InvalidModelFile(
        path,
        "is a pickle, which can run any program when it is read; it is never "
        "read. Export the model as ONNX, or its arrays as .npz or JSON "
        "(docs/interchange.md)");
  }
  if (absl::EndsWith(name, ".keras")) {
    return InvalidModelFile(path,
                            "is a Keras archive; load it in Keras and save the "
                            "same model with model.save(\"x.h5\")");
  }
  if (absl::EndsWith(name, ".h5") || absl::EndsWith(name, ".hdf5")) {
    return LstmsFromKeras(path, keras);
  }
  const bool onnx = absl::EndsWith(name, ".onnx");
  const bool npz = absl::EndsWith(name, ".npz");
  if (!onnx && !npz && !absl::EndsWith(name, ".json")) {
    return InvalidModelFile(
        path, "has no known ending; use .onnx, .h5, .hdf5, .json or .npz");
  }
  const auto bytes = ReadFileBytes(path, limits::kMaxBundleBytes);
  if (!bytes.ok()) return AsModelFileError(bytes.status());
  if (onnx) return LstmsFromOnnx(path, *bytes);
  return npz ? HmmsFromNpz(path, *bytes) : HmmsFromJson(path, *bytes);
}

}  // namespace tactus::internal

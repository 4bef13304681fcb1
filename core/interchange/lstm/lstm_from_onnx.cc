#include "core/interchange/lstm/lstm_from_onnx.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/bundle/field_count.h"
#include "core/interchange/lstm/lstm_graph.h"
#include "core/interchange/lstm/onnx_names.h"
#include "core/interchange/lstm/onnx_subset.pb.h"
#include "core/interchange/model/inputs_json.h"
#include "core/interchange/model/model_file_error.h"

namespace tactus::internal {
namespace {

constexpr int64_t kMinOpset = 7;
constexpr int64_t kMaxOpset = 17;

absl::StatusOr<int64_t> OpsetOf(const onnx::ModelProto& model) {
  for (const onnx::OperatorSetIdProto& opset : model.opset_import()) {
    if (!opset.domain().empty() && opset.domain() != "ai.onnx") continue;
    if (opset.version() >= kMinOpset && opset.version() <= kMaxOpset) {
      return opset.version();
    }
    return InvalidModel("opset", opset.version(),
                        absl::StrCat(kMinOpset, " to ", kMaxOpset));
  }
  return InvalidModel("opset", "absent",
                      absl::StrCat(kMinOpset, " to ", kMaxOpset));
}

absl::Status ReadClassNames(const OrderedJson& json, ForeignModel* out) {
  if (!json.is_array()) {
    return InvalidModel(kOnnxClassNames, json.type_name(), "a list of texts");
  }
  for (const OrderedJson& name : json) {
    if (!name.is_string()) {
      return InvalidModel(kOnnxClassNames, name.type_name(), "texts");
    }
    out->class_names.push_back(name.get<std::string>());
  }
  return absl::OkStatus();
}

absl::Status ReadMetadata(const onnx::ModelProto& model, ForeignModel* out) {
  for (const onnx::StringStringEntryProto& entry : model.metadata_props()) {
    const bool names = entry.key() == kOnnxClassNames;
    if (!names && entry.key() != kOnnxInputs) continue;
    const OrderedJson json =
        OrderedJson::parse(entry.value(), nullptr, /*allow_exceptions=*/false);
    if (names) {
      TACTUS_RETURN_IF_ERROR(ReadClassNames(json, out));
    } else if (json.is_object()) {
      TACTUS_RETURN_IF_ERROR(ReadInputs(json, out));
    } else {
      return InvalidModel(kOnnxInputs, json.type_name(), "a JSON object");
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<ForeignModel> Read(const onnx::ModelProto& model) {
  TACTUS_ASSIGN_OR_RETURN(const int64_t opset, OpsetOf(model));
  ForeignModel out;
  TACTUS_ASSIGN_OR_RETURN(out.lstms, NetworksOf(model.graph(), opset));
  TACTUS_RETURN_IF_ERROR(ReadMetadata(model, &out));
  const size_t classes = out.lstms.front().classes();
  if (!out.class_names.empty() && out.class_names.size() != classes) {
    return InvalidModel(kOnnxClassNames, out.class_names.size(),
                        absl::StrCat(classes, " texts, one per class"));
  }
  return out;
}

}  // namespace

absl::StatusOr<ForeignModel> LstmsFromOnnx(absl::string_view path,
                                           absl::string_view bytes) {
  if (bytes.size() > limits::kMaxBundleBytes) {
    return InvalidModelFile(
        path, absl::StrCat("has ", bytes.size(), " bytes; the limit is ",
                           limits::kMaxBundleBytes));
  }
  onnx::ModelProto message;
  if (!HasAtMostFields(*message.GetDescriptor(), bytes,
                       limits::kMaxBundleFields) ||
      !message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())) ||
      !message.has_graph()) {
    return InvalidModelFile(path,
                            "is not an ONNX model, is cut short or is damaged");
  }
  auto model = Read(message);
  if (!model.ok()) return Annotate(model.status(), path);
  return model;
}

}  // namespace tactus::internal

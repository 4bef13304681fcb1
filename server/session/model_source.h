// File: model_source.h
//
// ModelSource: where a stream finds the model it will use until its end. The
// registry implements it; tests bring their own.
//
// Find may be called from any thread. The returned share keeps the model
// alive, whatever the source does later.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/compiled_model.h"

namespace tactus::server {

// One version of a model, held for as long as this is.
struct PinnedModel {
  std::shared_ptr<const CompiledModel> model;
  // "models/M/versions/V".
  std::string version_name;
  // SHA-256 of the bundle, 64 hexadecimal digits.
  std::string sha256;
};

class ModelSource {
 public:
  virtual ~ModelSource() = default;

  // `name` is "default", "M", "models/M" or "models/M/versions/V"; empty
  // means "default". MODEL_NOT_FOUND otherwise.
  virtual absl::StatusOr<PinnedModel> Find(absl::string_view name) const = 0;
};

}  // namespace tactus::server

// File: model_source.h
//
// ModelSource: finds the model that a stream uses until its end. The registry
// implements it; tests have separate implementations.
//
//   auto pinned = models.Find("default", client_id);
//
// Thread-safe. The returned pointer keeps the model alive, whatever the source
// does later.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/compiled_model.h"

namespace tactus::internal::server {

// One version of a model; keeps it in memory.
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

  // `name` is an alias ("A" or "aliases/A"), a model ("M" or "models/M": its
  // newest version), "models/M/versions/V" or "M@V"; empty means "default". An
  // alias may give some robots, by their `client_id`, another version.
  // MODEL_NOT_FOUND for any other name.
  virtual absl::StatusOr<PinnedModel> Find(
      absl::string_view name, absl::string_view client_id) const = 0;

  // The version that answers the contacts of streams with this name of a model
  // once more, unseen; nothing if there is none.
  virtual std::optional<PinnedModel> Shadow(absl::string_view /*name*/) const {
    return std::nullopt;
  }

  // The newest version of each model, by name.
  virtual std::vector<PinnedModel> Newest() const { return {}; }

  // Changes whenever a later Find may return another version for a name.
  // Lock-free: streams compare it with each message.
  virtual uint64_t generation() const { return 0; }
};

}  // namespace tactus::internal::server

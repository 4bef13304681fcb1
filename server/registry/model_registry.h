// File: model_registry.h
//
// ModelRegistry: the models this server can classify with. Each bundle is
// decoded, compiled and put through its warm-up trial before any stream can
// find it; a bad one changes nothing.
//
//   ModelRegistry registry;
//   registry.Add("default", DefaultBundle());
//   auto pinned = registry.Find("default");
//
// Thread-safe. Streams lock it for a look-up when they start, never later.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/session/model_source.h"

namespace tactus::server {

class ModelRegistry : public ModelSource {
 public:
  // Adds the bundle as the next version of models/{model} and makes it the one
  // that new streams find. INVALID_CONFIG for a name that is not 1 to 64 of
  // a-z, 0-9, '-'; else what DecodeBundle and RunWarmUp say.
  absl::Status Add(absl::string_view model, absl::string_view bundle);

  absl::StatusOr<PinnedModel> Find(absl::string_view name) const override;

  // "models/M/versions/V" of all models, oldest first within each.
  std::vector<std::string> versions() const;

 private:
  mutable std::mutex mutex_;
  // By "models/M"; version V is at index V - 1.
  std::map<std::string, std::vector<PinnedModel>> models_;
};

// The bytes of a bundle file; IO if it cannot be read, BUNDLE_CORRUPT if it is
// larger than any bundle.
absl::StatusOr<std::string> ReadBundleFile(const std::string& path);

}  // namespace tactus::server

// File: model_registry.h
//
// ModelRegistry: the models that this server classifies with. A bundle is
// decoded, compiled and checked by its warm-up trial before any stream can find
// it. A bad bundle changes nothing.
//
//   ModelRegistry registry;
//   TACTUS_RETURN_IF_ERROR(registry.Add("default", DefaultBundle()));
//   auto pinned = registry.Find("default");
//
// Thread-safe. Streams lock it for a look-up when they start and after a
// version was added, never per frame.
#pragma once

#include <atomic>
#include <cstdint>
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
  // Adds the bundle as the next version of models/{model}. New streams find
  // this version; streams that use an older one keep it and get a notice.
  // INVALID_CONFIG if the name is not 1 to 64 characters of a-z, 0-9 and '-';
  // otherwise the errors of DecodeBundle and RunWarmUp.
  absl::Status Add(absl::string_view model, absl::string_view bundle);

  absl::StatusOr<PinnedModel> Find(absl::string_view name) const override;
  uint64_t generation() const override { return generation_.load(); }

  // "models/M/versions/V" of all versions, the oldest of each model first.
  std::vector<std::string> versions() const;

 private:
  mutable std::mutex mutex_;
  // By "models/M"; version V is at index V - 1.
  std::map<std::string, std::vector<PinnedModel>> models_;
  // Number of versions.
  std::atomic<uint64_t> generation_ = 0;
};

// The bytes of a bundle file. IO if it cannot be read, BUNDLE_CORRUPT if it is
// larger than any bundle.
absl::StatusOr<std::string> ReadBundleFile(const std::string& path);

}  // namespace tactus::server

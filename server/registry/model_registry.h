// File: model_registry.h
//
// ModelRegistry: the model versions in memory, and the aliases under which
// streams find them. A bundle is decoded, compiled and checked by its warm-up
// trial before any stream can find it. A bad bundle changes nothing.
//
//   ModelRegistry registry;
//   TACTUS_RETURN_IF_ERROR(registry.AddBuiltIn("default", DefaultBundle()));
//   auto pinned = registry.Find("default", "robot-7");
//
// Thread-safe. Streams lock it for a look-up when they start and after a
// change, never per frame. Nothing is decoded under the lock.
#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "server/session/model_source.h"

namespace tactus::internal::server {

// What an alias names. All are "models/M/versions/V".
struct AliasTarget {
  std::string version;
  // Some robots get this one; empty for none.
  std::string canary_version = {};
  // Robots of 1,000 that get it.
  uint32_t canary_per_mille = 0;
  // Answers contacts once more, unseen; empty for none.
  std::string shadow_version = {};
};

class ModelRegistry : public ModelSource {
 public:
  // Decodes a bundle and compares its warm-up trial's answers. Takes
  // milliseconds and changes nothing. The errors of DecodeBundle and RunWarmUp.
  static absl::StatusOr<PinnedModel> Load(absl::string_view bundle);

  // Adds a bundle as the next version of models/{model}, which no stored model
  // may have as its name. INVALID_NAME; the errors of Load.
  absl::Status AddBuiltIn(absl::string_view model, absl::string_view bundle);
  // Adds version `version` (from 1) of models/{model}.
  void Add(absl::string_view model, uint32_t version, PinnedModel pinned);
  // Streams that use the version keep it.
  void Remove(absl::string_view model, uint32_t version);
  // Lets aliases/{alias} name `target`, whose versions were added. New streams
  // get the new version; the others keep theirs and get a notice.
  void SetAlias(absl::string_view alias, const AliasTarget& target);

  absl::StatusOr<PinnedModel> Find(absl::string_view name,
                                   absl::string_view client_id) const override;
  std::optional<PinnedModel> Shadow(absl::string_view name) const override;
  uint64_t generation() const override { return generation_.load(); }

  std::vector<PinnedModel> Newest() const override;

  // Names that would have been right instead of `name`: the versions of its
  // model, the newest first; if there is no such model, all aliases and models.
  std::vector<std::string> KnownNames(absl::string_view name) const;
  // True if AddBuiltIn was called for this model.
  bool IsBuiltIn(absl::string_view model) const;
  // "models/M/versions/V" of all versions, the oldest of each model first.
  std::vector<std::string> versions() const;

 private:
  struct Entry {
    // By number.
    std::map<uint32_t, PinnedModel> versions;
    bool built_in = false;
  };

  // With the lock.
  const PinnedModel* FindVersion(absl::string_view name) const;

  mutable std::mutex mutex_;
  std::map<std::string, Entry, std::less<>> models_;
  std::map<std::string, AliasTarget, std::less<>> aliases_;
  // Number of changes.
  std::atomic<uint64_t> generation_ = 0;
};

// True if a robot is among `per_mille` of 1,000, by a hash of its id. Alias and
// id decide alone, so each start of a stream gives the same answer.
bool IsCanary(absl::string_view alias, absl::string_view client_id,
              uint32_t per_mille);

// The bytes of a bundle file. IO if it cannot be read, BUNDLE_CORRUPT if it is
// larger than any bundle.
absl::StatusOr<std::string> ReadBundleFile(const std::string& path);

}  // namespace tactus::internal::server

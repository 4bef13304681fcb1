#include "server/registry/model_registry.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/bundle/bundle.h"

namespace tactus::server {
namespace {

constexpr absl::string_view kModels = "models/";
constexpr absl::string_view kVersions = "/versions/";
constexpr size_t kMaxModelName = 64;

bool IsModelName(absl::string_view name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-';
  };
  return !name.empty() && name.size() <= kMaxModelName &&
         std::all_of(name.begin(), name.end(), allowed);
}

}  // namespace

absl::Status ModelRegistry::Add(absl::string_view model,
                                absl::string_view bundle) {
  if (!IsModelName(model)) {
    return InvalidConfig("model name", Quoted(model),
                         "1 to 64 of a-z, 0-9 and -");
  }
  PinnedModel pinned;
  TACTUS_ASSIGN_OR_RETURN(pinned.model, DecodeBundle(bundle));
  TACTUS_RETURN_IF_ERROR(RunWarmUp(*pinned.model));
  pinned.sha256 = BundleSha256(bundle);

  const std::string name = absl::StrCat(kModels, model);
  const std::lock_guard lock(mutex_);
  std::vector<PinnedModel>& versions = models_[name];
  pinned.version_name = absl::StrCat(name, kVersions, versions.size() + 1);
  versions.push_back(std::move(pinned));
  generation_.fetch_add(1);
  return absl::OkStatus();
}

absl::StatusOr<PinnedModel> ModelRegistry::Find(absl::string_view name) const {
  absl::string_view model = name.empty() ? "default" : name;
  absl::ConsumePrefix(&model, kModels);
  uint64_t version = 0;
  const size_t split = model.find(kVersions);
  if (split != absl::string_view::npos) {
    const absl::string_view digits = model.substr(split + kVersions.size());
    if (!absl::SimpleAtoi(digits, &version) || version == 0) {
      return ModelNotFound(name);
    }
    model = model.substr(0, split);
  }
  const std::lock_guard lock(mutex_);
  const auto found = models_.find(absl::StrCat(kModels, model));
  if (found == models_.end() || version > found->second.size()) {
    return ModelNotFound(name);
  }
  return version == 0 ? found->second.back() : found->second[version - 1];
}

std::vector<std::string> ModelRegistry::versions() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [model, versions] : models_) {
    for (const PinnedModel& pinned : versions) {
      names.push_back(pinned.version_name);
    }
  }
  return names;
}

absl::StatusOr<std::string> ReadBundleFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) return IoError(path, std::strerror(errno));
  std::string bytes;
  // One byte more than the limit shows that the file is too large.
  bytes.resize(limits::kMaxBundleBytes + 1);
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  if (file.bad()) return IoError(path, "read failed");
  bytes.resize(file.gcount());
  if (bytes.size() > limits::kMaxBundleBytes) {
    return BundleCorrupt(absl::StrCat(path, " is larger than ",
                                      limits::kMaxBundleBytes, " bytes"));
  }
  bytes.shrink_to_fit();
  return bytes;
}

}  // namespace tactus::server

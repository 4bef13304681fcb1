#include "server/registry/model_registry.h"

#include <cstring>
#include <fstream>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/bundle/bundle.h"
#include "server/names/resource_names.h"

namespace tactus::internal::server {
namespace {

constexpr absl::string_view kModels = "models/";
constexpr absl::string_view kAliases = "aliases/";
constexpr absl::string_view kVersions = "/versions/";

std::string VersionName(absl::string_view model, uint32_t version) {
  return absl::StrCat(kModels, model, kVersions, version);
}

// "arm/versions/3" and "arm@3" as {"arm", "3"}; "arm" as {"arm", ""}.
std::pair<absl::string_view, absl::string_view> SplitVersion(
    absl::string_view name) {
  for (const absl::string_view mark : {kVersions, absl::string_view("@")}) {
    const size_t split = name.find(mark);
    if (split == absl::string_view::npos) continue;
    return {name.substr(0, split), name.substr(split + mark.size())};
  }
  return {name, ""};
}

}  // namespace

absl::StatusOr<PinnedModel> ModelRegistry::Load(absl::string_view bundle) {
  PinnedModel pinned;
  TACTUS_ASSIGN_OR_RETURN(pinned.model, DecodeBundle(bundle));
  TACTUS_RETURN_IF_ERROR(RunWarmUp(*pinned.model));
  pinned.sha256 = BundleSha256(bundle);
  return pinned;
}

absl::Status ModelRegistry::AddBuiltIn(absl::string_view model,
                                       absl::string_view bundle) {
  if (!IsResourceId(model)) {
    return InvalidName(model, "1 to 64 of a-z, 0-9 and -");
  }
  TACTUS_ASSIGN_OR_RETURN(PinnedModel pinned, Load(bundle));
  uint32_t version = 0;
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = models_[std::string(model)];
    entry.built_in = true;
    version = static_cast<uint32_t>(entry.versions.size()) + 1;
  }
  Add(model, version, std::move(pinned));
  return absl::OkStatus();
}

void ModelRegistry::Add(absl::string_view model, uint32_t version,
                        PinnedModel pinned) {
  pinned.version_name = VersionName(model, version);
  const std::lock_guard lock(mutex_);
  models_[std::string(model)].versions[version] = std::move(pinned);
  generation_.fetch_add(1);
}

void ModelRegistry::Remove(absl::string_view model, uint32_t version) {
  const std::lock_guard lock(mutex_);
  const auto found = models_.find(model);
  if (found == models_.end()) return;
  found->second.versions.erase(version);
  if (found->second.versions.empty()) models_.erase(found);
  generation_.fetch_add(1);
}

void ModelRegistry::SetAlias(absl::string_view alias,
                             const AliasTarget& target) {
  const std::lock_guard lock(mutex_);
  aliases_[std::string(alias)] = target;
  generation_.fetch_add(1);
}

const PinnedModel* ModelRegistry::FindVersion(absl::string_view name) const {
  uint32_t version = 0;
  // "M/versions/V" or "M@V".
  const auto [id, number] = SplitVersion(name);
  if (id.size() != name.size()) {
    if (!absl::SimpleAtoi(number, &version) || version == 0) return nullptr;
    name = id;
  }
  const auto model = models_.find(name);
  if (model == models_.end()) return nullptr;
  const auto& versions = model->second.versions;
  if (version == 0) {
    return versions.empty() ? nullptr : &versions.rbegin()->second;
  }
  const auto found = versions.find(version);
  return found == versions.end() ? nullptr : &found->second;
}

absl::StatusOr<PinnedModel> ModelRegistry::Find(
    absl::string_view name, absl::string_view client_id) const {
  absl::string_view rest = name.empty() ? "default" : name;
  const bool model_only = absl::ConsumePrefix(&rest, kModels);
  const bool alias_only = !model_only && absl::ConsumePrefix(&rest, kAliases);
  std::unique_lock lock(mutex_);
  const PinnedModel* found = nullptr;
  const auto alias = model_only ? aliases_.end() : aliases_.find(rest);
  if (alias != aliases_.end()) {
    const AliasTarget& target = alias->second;
    const bool canary = !target.canary_version.empty() &&
                        IsCanary(rest, client_id, target.canary_per_mille);
    absl::string_view version = canary ? target.canary_version : target.version;
    absl::ConsumePrefix(&version, kModels);
    found = FindVersion(version);
  } else if (!alias_only) {
    found = FindVersion(rest);
  }
  if (found != nullptr) return *found;
  lock.unlock();
  return ModelNotFound(name, KnownNames(name));
}

std::optional<PinnedModel> ModelRegistry::Shadow(absl::string_view name) const {
  absl::string_view rest = name.empty() ? "default" : name;
  absl::ConsumePrefix(&rest, kAliases);
  const std::lock_guard lock(mutex_);
  const auto alias = aliases_.find(rest);
  if (alias == aliases_.end()) return std::nullopt;
  absl::string_view version = alias->second.shadow_version;
  if (!absl::ConsumePrefix(&version, kModels)) return std::nullopt;
  const PinnedModel* found = FindVersion(version);
  return found == nullptr ? std::nullopt : std::optional(*found);
}

std::vector<std::string> ModelRegistry::KnownNames(
    absl::string_view name) const {
  absl::ConsumePrefix(&name, kModels);
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  const auto model = models_.find(SplitVersion(name).first);
  if (model != models_.end()) {
    const auto& versions = model->second.versions;
    for (auto v = versions.rbegin(); v != versions.rend(); ++v) {
      names.push_back(absl::StrCat(model->first, "@", v->first));
    }
    return names;
  }
  for (const auto& [alias, target] : aliases_) {
    names.push_back(absl::StrCat(kAliases, alias));
  }
  for (const auto& [id, entry] : models_) {
    names.push_back(absl::StrCat(kModels, id));
  }
  return names;
}

std::vector<PinnedModel> ModelRegistry::Newest() const {
  const std::lock_guard lock(mutex_);
  std::vector<PinnedModel> newest;
  for (const auto& [id, entry] : models_) {
    newest.push_back(entry.versions.rbegin()->second);
  }
  return newest;
}

bool ModelRegistry::IsBuiltIn(absl::string_view model) const {
  const std::lock_guard lock(mutex_);
  const auto found = models_.find(model);
  return found != models_.end() && found->second.built_in;
}

std::vector<std::string> ModelRegistry::versions() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [model, entry] : models_) {
    for (const auto& [number, pinned] : entry.versions) {
      names.push_back(pinned.version_name);
    }
  }
  return names;
}

bool IsCanary(absl::string_view alias, absl::string_view client_id,
              uint32_t per_mille) {
  // The alias takes part, so that two aliases do not pick the same robots.
  const std::string digest = Sha256Of(absl::StrCat(alias, "/", client_id));
  uint32_t hash = 0;
  std::memcpy(&hash, digest.data(), sizeof hash);
  return hash % 1000 < per_mille;
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

}  // namespace tactus::internal::server

#include "server/records/model_store.h"

#include <chrono>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/bundle/bundle.h"
#include "core/store/numbers.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/blob_parts.h"
#include "server/records/dataset_store.h"

namespace tactus::internal::server {
namespace {

constexpr char kModels[] = "models";
constexpr char kAliases[] = "aliases";
// The number of the last change of versions or aliases.
constexpr char kServedChanges[] = "served changes";
// For other servers that do not serve a change yet.
constexpr std::chrono::milliseconds kPatienceWithOthers(2'000);

// The newest version of each model first.
absl::StatusOr<std::vector<v1::ModelVersion>> VersionsOf(
    const Transaction& look, absl::string_view prefix) {
  return ScanRecords<v1::ModelVersion>(
      look, Table::kModelVersions,
      {.prefix = std::string(prefix), .backwards = true});
}

void Describe(const PinnedModel& pinned, v1::ModelVersion& version) {
  const Model& model = pinned.model->model();
  version.set_sha256(pinned.sha256);
  version.clear_class_names();
  for (const std::string& name : model.class_names) {
    version.add_class_names(name);
  }
  version.set_layout_class(model.layout.name);
  version.set_trials(model.provenance.trials);
  version.set_program_version(model.provenance.version);
}

// A model that may get a version: "models/ID", and not built in.
absl::StatusOr<ResourceName> ParseOwnModel(absl::string_view model,
                                           const ModelRegistry& registry) {
  TACTUS_ASSIGN_OR_RETURN(ResourceName parent, ParseName(model, kModels));
  if (parent.version != 0) return InvalidName(model, "models/ID");
  if (registry.IsBuiltIn(parent.id)) {
    return InvalidName(model,
                       "one that the server's program or command line "
                       "does not provide");
  }
  return parent;
}

}  // namespace

absl::StatusOr<ModelStore::Followed> ModelStore::Follow() {
  const std::lock_guard lock(following_);
  Followed followed;
  std::vector<v1::ModelVersion> versions;
  std::vector<v1::Alias> aliases;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(followed.change,
                                LastNumber(look, kServedChanges));
        TACTUS_ASSIGN_OR_RETURN(versions, VersionsOf(look, ""));
        TACTUS_ASSIGN_OR_RETURN(
            aliases, ScanRecords<v1::Alias>(look, Table::kAliases, {}));
        return absl::OkStatus();
      }));
  failures_.clear();
  std::set<std::string> stored;
  for (const v1::ModelVersion& version : versions) {
    stored.insert(version.name());
    if (CheckServed(version.name()).ok()) continue;
    TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                            ParseVersionName(version.name(), kModels));
    auto bundle = Bundle(version);
    absl::StatusOr<PinnedModel> pinned =
        bundle.ok() ? ModelRegistry::Load(*bundle) : bundle.status();
    if (pinned.ok()) {
      registry_->Add(name.id, name.version, *std::move(pinned));
    } else {
      failures_.push_back(
          absl::StrCat(version.name(), ": ", pinned.status().message()));
    }
  }
  for (const v1::Alias& alias : aliases) {
    followed.serves_all &= CheckServed(alias.model_version()).ok();
    Serve(alias);
  }
  // Only now: no alias names them any longer.
  for (const std::string& version : registry_->versions()) {
    TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                            ParseVersionName(version, kModels));
    if (!stored.contains(version) && !registry_->IsBuiltIn(name.id)) {
      registry_->Remove(name.id, name.version);
    }
  }
  // Whoever could not load a version, or not say what it serves, tries again
  // with the next news.
  followed_.reset();
  const bool said = replica_ == nullptr || !followed.serves_all ||
                    replica_->SayServed(followed.change).ok();
  if (said && failures_.empty()) followed_ = followed.change;
  return followed;
}

absl::StatusOr<bool> ModelStore::HasNews() const {
  uint64_t last = 0;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(last, LastNumber(look, kServedChanges));
        return absl::OkStatus();
      }));
  const std::lock_guard lock(following_);
  return followed_ != last;
}

std::vector<std::string> ModelStore::failures() const {
  const std::lock_guard lock(following_);
  return failures_;
}

void ModelStore::ServeChange(v1::Alias* alias) {
  const auto followed = Follow();
  if (!followed.ok() || replica_ == nullptr || alias == nullptr) return;
  const auto lagging =
      replica_->WaitServed(followed->change, kPatienceWithOthers);
  if (!lagging.ok()) return;
  for (const std::string& name : *lagging) alias->add_lagging_replicas(name);
}

absl::Status ModelStore::FollowOthers() {
  return replica_ == nullptr ? absl::OkStatus() : Follow().status();
}

absl::Status ModelStore::CountChange(Transaction& change) {
  TACTUS_ASSIGN_OR_RETURN(const uint32_t last,
                          LastNumber(change, kServedChanges));
  return change.Put(Table::kNumbers, kServedChanges, NumberKey(last + 1));
}

absl::StatusOr<v1::ModelVersion> ModelStore::AddVersion(
    absl::string_view model, absl::string_view bundle, v1::ModelVersion origin,
    const Caller& caller, const Lock* job) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parent,
                          ParseOwnModel(model, *registry_));
  TACTUS_ASSIGN_OR_RETURN(const PinnedModel pinned,
                          ModelRegistry::Load(bundle));
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  v1::ModelVersion version = std::move(origin);
  uint32_t number = 0;
  bool known = false;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const auto old,
                                VersionsOf(look, parent.id + "/"));
        for (const v1::ModelVersion& other : old) {
          if (version.operation().empty() ||
              other.operation() != version.operation()) {
            continue;
          }
          version = other;
          known = true;
          return absl::OkStatus();
        }
        TACTUS_RETURN_IF_ERROR(CheckModelBytes(
            look, quotas_, caller.name, static_cast<int64_t>(bundle.size())));
        TACTUS_ASSIGN_OR_RETURN(number, LastNumber(look, parent.Parent()));
        ++number;
        return absl::OkStatus();
      }));
  if (known) return version;

  BlobStore::Batch batch = data_->blobs().NewBatch();
  TACTUS_ASSIGN_OR_RETURN(*version.mutable_blob_sha256(), batch.Add(bundle));
  TACTUS_RETURN_IF_ERROR(batch.Commit());
  ResourceName name = parent;
  name.version = number;
  Describe(pinned, version);
  version.set_name(name.ToString());
  version.set_bytes(static_cast<int64_t>(bundle.size()));
  version.set_create_time_ms(now_());
  version.set_requester(caller.name);
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
        if (job != nullptr) TACTUS_RETURN_IF_ERROR(job->StillHeld(change));
        TACTUS_RETURN_IF_ERROR(PutRecord(change, Table::kModelVersions,
                                         CatalogKey(name), version));
        TACTUS_RETURN_IF_ERROR(
            change.Put(Table::kNumbers, parent.Parent(), NumberKey(number)));
        TACTUS_RETURN_IF_ERROR(CountChange(change));
        return Audit(change, caller, now_(), "create", version.name());
      }));
  ServeChange();
  return version;
}

absl::StatusOr<v1::ModelVersion> ModelStore::Import(absl::string_view model,
                                                    const Spool& bundle,
                                                    const Caller& caller) {
  TACTUS_RETURN_IF_ERROR(ParseOwnModel(model, *registry_).status());
  const std::lock_guard lock(importing_);
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes, bundle.Read());
  TACTUS_RETURN_IF_ERROR(CheckBundleFields(bytes));
  return AddVersion(model, bytes, {}, caller);
}

absl::StatusOr<v1::ModelVersion> ModelStore::Get(absl::string_view name) const {
  std::string wanted(name);
  std::optional<v1::ModelVersion> found;
  std::vector<v1::Alias> aliases;
  TACTUS_RETURN_IF_ERROR(data_->catalog().Look([&](const Transaction& look)
                                                   -> absl::Status {
    if (absl::StartsWith(name, "aliases/")) {
      TACTUS_ASSIGN_OR_RETURN(const ResourceName alias_name,
                              ParseName(name, kAliases));
      TACTUS_ASSIGN_OR_RETURN(const auto alias, FindAlias(look, alias_name));
      if (!alias.has_value()) return NoAlias(alias_name);
      wanted = alias->model_version();
    }
    TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                            ParseName(wanted, kModels));
    TACTUS_ASSIGN_OR_RETURN(aliases,
                            ScanRecords<v1::Alias>(look, Table::kAliases, {}));
    if (parsed.version != 0) {
      TACTUS_ASSIGN_OR_RETURN(
          found, GetRecord<v1::ModelVersion>(look, Table::kModelVersions,
                                             CatalogKey(parsed)));
      return absl::OkStatus();
    }
    TACTUS_ASSIGN_OR_RETURN(const auto all, VersionsOf(look, parsed.id + "/"));
    if (!all.empty()) found = all.front();
    return absl::OkStatus();
  }));
  if (!found.has_value()) {
    TACTUS_ASSIGN_OR_RETURN(const PinnedModel pinned,
                            registry_->Find(wanted, ""));
    found.emplace();
    found->set_name(pinned.version_name);
    found->set_built_in(true);
    Describe(pinned, *found);
  }
  for (const v1::Alias& alias : aliases) {
    if (alias.model_version() == found->name() ||
        alias.canary().model_version() == found->name() ||
        alias.shadow_version() == found->name()) {
      found->add_aliases(alias.name());
    }
  }
  return *std::move(found);
}

absl::StatusOr<std::string> ModelStore::Bundle(
    const v1::ModelVersion& version) const {
  if (version.blob_sha256().empty()) {
    TACTUS_ASSIGN_OR_RETURN(const PinnedModel built_in,
                            registry_->Find(version.name(), ""));
    return EncodeBundle(built_in.model->model());
  }
  auto bundle =
      data_->blobs().Read(version.blob_sha256(), limits::kMaxBundleBytes);
  if (!bundle.ok()) return Explain(version, bundle.status());
  return bundle;
}

absl::Status ModelStore::ReadBundle(
    const v1::ModelVersion& version,
    absl::FunctionRef<absl::Status(absl::string_view)> take) const {
  if (!version.blob_sha256().empty()) {
    return Explain(version, ReadBlobParts(*data_, version.blob_sha256(),
                                          limits::kMaxBundleBytes, take));
  }
  TACTUS_ASSIGN_OR_RETURN(const std::string bundle, Bundle(version));
  for (size_t done = 0; done < bundle.size(); done += limits::kMaxChunkBytes) {
    TACTUS_RETURN_IF_ERROR(
        take(absl::string_view(bundle).substr(done, limits::kMaxChunkBytes)));
  }
  return absl::OkStatus();
}

absl::Status ModelStore::Explain(const v1::ModelVersion& version,
                                 const absl::Status& error) const {
  if (!absl::IsDataLoss(error)) return error;
  // A deletion erases the record before it removes the blob.
  const absl::Status found = Get(version.name()).status();
  return absl::IsNotFound(found) ? found : error;
}

absl::StatusOr<Page<v1::ModelVersion>> ModelStore::List(
    absl::string_view model, int page_size,
    absl::string_view page_token) const {
  ResourceName parent;
  if (!model.empty()) {
    TACTUS_ASSIGN_OR_RETURN(parent, ParseName(model, kModels));
  }
  // Versions are few, so a page is cut from all of them: "by model, the newest
  // first" is no order of the keys.
  std::vector<std::string> names;
  for (const std::string& name : registry_->versions()) {
    TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                            ParseVersionName(name, kModels));
    if (!model.empty() && parsed.id != parent.id) continue;
    auto place = names.end();
    while (place != names.begin() &&
           absl::StartsWith(*std::prev(place), parsed.Parent() + "/")) {
      --place;
    }
    names.insert(place, name);
  }
  Page<v1::ModelVersion> page;
  bool found = page_token.empty();
  for (const std::string& name : names) {
    if (!found) {
      found = name == page_token;
      continue;
    }
    if (static_cast<int>(page.items.size()) == page_size) {
      page.next_token = page.items.back().name();
      break;
    }
    auto version = Get(name);
    // It was deleted since the names were listed.
    if (absl::IsNotFound(version.status())) continue;
    TACTUS_RETURN_IF_ERROR(version.status());
    page.items.push_back(*std::move(version));
  }
  if (!found) {
    return InvalidConfig("page_token", Quoted(page_token),
                         "the next_page_token of the page before");
  }
  return page;
}

absl::Status ModelStore::Delete(absl::string_view name, const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseVersionName(name, kModels));
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  std::string blob;
  bool shared = false;
  // A full disk must not prevent what makes room.
  return data_->reserve().With([&]() -> absl::Status {
    TACTUS_RETURN_IF_ERROR(
        data_->catalog().Change([&](Transaction& change) -> absl::Status {
          TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
          shared = false;
          TACTUS_ASSIGN_OR_RETURN(
              const auto version,
              GetRecord<v1::ModelVersion>(change, Table::kModelVersions,
                                          CatalogKey(parsed)));
          if (!version.has_value()) {
            return ModelNotFound(name, registry_->KnownNames(name));
          }
          TACTUS_ASSIGN_OR_RETURN(
              const auto aliases,
              ScanRecords<v1::Alias>(change, Table::kAliases, {}));
          for (const v1::Alias& alias : aliases) {
            if (alias.model_version() == name ||
                alias.previous_version() == name ||
                alias.canary().model_version() == name ||
                alias.shadow_version() == name) {
              return ModelInUse(name, alias.name());
            }
          }
          blob = version->blob_sha256();
          TACTUS_ASSIGN_OR_RETURN(const auto all, VersionsOf(change, ""));
          for (const v1::ModelVersion& other : all) {
            shared |= other.name() != name && other.blob_sha256() == blob;
          }
          TACTUS_RETURN_IF_ERROR(
              change.Erase(Table::kModelVersions, CatalogKey(parsed)));
          TACTUS_RETURN_IF_ERROR(CountChange(change));
          return Audit(change, caller, now_(), "delete", name);
        }));
    ServeChange();
    // A blob that stays behind costs room, nothing else: the version is
    // deleted.
    if (!shared) data_->blobs().Remove(blob).IgnoreError();
    return absl::OkStatus();
  });
}

absl::Status ModelStore::CheckServed(absl::string_view version) const {
  TACTUS_RETURN_IF_ERROR(ParseVersionName(version, kModels).status());
  return registry_->Find(version, "").status();
}

void ModelStore::Serve(const v1::Alias& alias) {
  if (!CheckServed(alias.model_version()).ok()) return;
  AliasTarget target = {.version = alias.model_version()};
  if (CheckServed(alias.canary().model_version()).ok()) {
    target.canary_version = alias.canary().model_version();
    target.canary_per_mille = alias.canary().per_mille();
  }
  if (CheckServed(alias.shadow_version()).ok()) {
    target.shadow_version = alias.shadow_version();
  }
  registry_->SetAlias(alias.name().substr(sizeof kAliases), target);
}

}  // namespace tactus::internal::server

#include "server/records/model_store.h"

#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/bundle/bundle.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/blob_parts.h"
#include "server/records/dataset_store.h"

namespace tactus::internal::server {
namespace {

constexpr char kModels[] = "models";
constexpr char kAliases[] = "aliases";
constexpr int kMaxHistory = 1'000;
constexpr uint32_t kMaxPerMille = 1'000;

absl::StatusOr<std::optional<v1::Alias>> FindAlias(const Transaction& look,
                                                   const ResourceName& name) {
  return GetRecord<v1::Alias>(look, Table::kAliases, name.id);
}

absl::Status NoAlias(const ResourceName& name) {
  return NoSuch(v1::ERROR_REASON_ALIAS_NOT_FOUND, "alias", name.ToString(),
                "trainctl models alias shows those that do");
}

absl::Status CheckEtag(const v1::Alias& alias, absl::string_view etag) {
  if (etag.empty() || etag == alias.etag()) return absl::OkStatus();
  return EtagMismatch(alias.name(), etag, alias.etag());
}

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

absl::StatusOr<std::vector<std::string>> ModelStore::Restore() {
  const std::lock_guard lock(mutex_);
  std::vector<v1::ModelVersion> versions;
  std::vector<v1::Alias> aliases;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(versions, VersionsOf(look, ""));
        TACTUS_ASSIGN_OR_RETURN(
            aliases, ScanRecords<v1::Alias>(look, Table::kAliases, {}));
        return absl::OkStatus();
      }));
  std::vector<std::string> failures;
  for (const v1::ModelVersion& version : versions) {
    TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                            ParseVersionName(version.name(), kModels));
    auto bundle = Bundle(version);
    absl::StatusOr<PinnedModel> pinned =
        bundle.ok() ? ModelRegistry::Load(*bundle) : bundle.status();
    if (pinned.ok()) {
      registry_->Add(name.id, name.version, *std::move(pinned));
    } else {
      failures.push_back(
          absl::StrCat(version.name(), ": ", pinned.status().message()));
    }
  }
  for (const v1::Alias& alias : aliases) Serve(alias);
  return failures;
}

absl::StatusOr<v1::ModelVersion> ModelStore::AddVersion(
    absl::string_view model, absl::string_view bundle, v1::ModelVersion origin,
    const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parent,
                          ParseOwnModel(model, *registry_));
  TACTUS_ASSIGN_OR_RETURN(PinnedModel pinned, ModelRegistry::Load(bundle));
  const std::lock_guard lock(mutex_);
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
        TACTUS_RETURN_IF_ERROR(PutRecord(change, Table::kModelVersions,
                                         CatalogKey(name), version));
        TACTUS_RETURN_IF_ERROR(
            change.Put(Table::kNumbers, parent.Parent(), NumberKey(number)));
        return Audit(change, caller, now_(), "create", version.name());
      }));
  registry_->Add(name.id, name.version, std::move(pinned));
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
  const std::lock_guard lock(mutex_);
  std::string blob;
  bool shared = false;
  // A full disk must not prevent what makes room.
  return data_->reserve().With([&]() -> absl::Status {
    TACTUS_RETURN_IF_ERROR(
        data_->catalog().Change([&](Transaction& change) -> absl::Status {
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
          return Audit(change, caller, now_(), "delete", name);
        }));
    registry_->Remove(parsed.id, parsed.version);
    // A blob that stays behind costs room, nothing else: the version is
    // deleted.
    if (!shared) data_->blobs().Remove(blob).IgnoreError();
    return absl::OkStatus();
  });
}

absl::StatusOr<std::vector<v1::Alias>> ModelStore::Aliases() const {
  std::vector<v1::Alias> aliases;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(
            aliases, ScanRecords<v1::Alias>(look, Table::kAliases, {}));
        return absl::OkStatus();
      }));
  return aliases;
}

absl::StatusOr<v1::Alias> ModelStore::GetAlias(absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed, ParseName(name, kAliases));
  std::optional<v1::Alias> found;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(found, FindAlias(look, parsed));
        return absl::OkStatus();
      }));
  if (!found.has_value()) return NoAlias(parsed);
  return *std::move(found);
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

absl::Status ModelStore::PutAlias(Transaction& change, v1::Alias& alias,
                                  const v1::AliasChange* entry) {
  const std::string id = alias.name().substr(sizeof kAliases);
  TACTUS_ASSIGN_OR_RETURN(const uint64_t number,
                          NextNumber(change, Table::kAudit));
  // Every change has an entry in the audit log, so its number never repeats.
  alias.set_etag(absl::StrCat(number));
  if (entry != nullptr) {
    TACTUS_RETURN_IF_ERROR(PutRecord(change, Table::kAliasChanges,
                                     absl::StrCat(id, "/", NumberKey(number)),
                                     *entry));
  }
  return PutRecord(change, Table::kAliases, id, alias);
}

absl::StatusOr<v1::Alias> ModelStore::UpdateAlias(
    const v1::UpdateAliasRequest& wanted, const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName(wanted.name(), kAliases));
  const std::lock_guard lock(mutex_);
  if (wanted.has_canary()) {
    TACTUS_RETURN_IF_ERROR(CheckServed(wanted.canary().model_version()));
    const uint32_t share = wanted.canary().per_mille();
    if (share < 1 || share > kMaxPerMille) {
      return InvalidConfig("canary.per_mille", share, "1 to 1000");
    }
  }
  if (!wanted.shadow_version().empty()) {
    TACTUS_RETURN_IF_ERROR(CheckServed(wanted.shadow_version()));
  }
  v1::Alias alias;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const auto old, FindAlias(change, name));
        if (old.has_value()) {
          alias = *old;
        } else {
          alias.set_name(name.ToString());
          const auto served = registry_->Find(name.id, "");
          if (served.ok()) alias.set_model_version(served->version_name);
        }
        TACTUS_RETURN_IF_ERROR(CheckEtag(alias, wanted.etag()));
        alias.clear_canary();
        if (wanted.has_canary()) *alias.mutable_canary() = wanted.canary();
        alias.set_shadow_version(wanted.shadow_version());
        alias.clear_gate();
        if (wanted.has_gate()) {
          // From here on the dataset is in use and can't be deleted.
          TACTUS_RETURN_IF_ERROR(
              DatasetStore::VersionIn(change, wanted.gate().dataset_version())
                  .status());
          *alias.mutable_gate() = wanted.gate();
        }
        TACTUS_RETURN_IF_ERROR(PutAlias(change, alias, nullptr));
        return Audit(change, caller, now_(), "update", alias.name());
      }));
  Serve(alias);
  return alias;
}

absl::StatusOr<v1::Alias> ModelStore::Promote(
    const v1::PromoteSpec& spec, bool forced, const Caller& caller,
    absl::FunctionRef<absl::StatusOr<bool>(Transaction&)> also) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName(spec.alias(), kAliases));
  const std::lock_guard lock(mutex_);
  v1::Alias alias;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const auto old, FindAlias(change, name));
        TACTUS_ASSIGN_OR_RETURN(const bool wanted, also(change));
        if (!wanted) {
          if (old.has_value()) alias = *old;
          return absl::OkStatus();
        }
        TACTUS_RETURN_IF_ERROR(CheckServed(spec.model_version()));
        if (old.has_value()) {
          alias = *old;
        } else {
          alias.set_name(name.ToString());
          // What streams of this name got so far, to be able to go back to it.
          const auto before = registry_->Find(name.id, "");
          if (before.ok()) alias.set_model_version(before->version_name);
        }
        // A job that moved the alias runs again if the server crashed before
        // its end was stored.
        if (old.has_value() && alias.model_version() == spec.model_version() &&
            alias.canary().model_version() != spec.model_version()) {
          return absl::OkStatus();
        }
        TACTUS_RETURN_IF_ERROR(CheckEtag(alias, spec.etag()));
        if (alias.model_version() != spec.model_version()) {
          alias.set_previous_version(alias.model_version());
        }
        alias.set_model_version(spec.model_version());
        if (alias.canary().model_version() == spec.model_version()) {
          alias.clear_canary();
        }
        if (alias.shadow_version() == spec.model_version()) {
          alias.clear_shadow_version();
        }
        v1::AliasChange entry;
        entry.set_model_version(alias.model_version());
        entry.set_time_ms(now_());
        entry.set_requester(caller.name);
        entry.set_forced(forced);
        TACTUS_RETURN_IF_ERROR(PutAlias(change, alias, &entry));
        return Audit(change, caller, now_(), forced ? "force" : "promote",
                     alias.name());
      }));
  Serve(alias);
  return alias;
}

absl::StatusOr<v1::Alias> ModelStore::Rollback(absl::string_view name,
                                               absl::string_view etag,
                                               const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed, ParseName(name, kAliases));
  const std::lock_guard lock(mutex_);
  v1::Alias alias;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const auto old, FindAlias(change, parsed));
        if (!old.has_value()) return NoAlias(parsed);
        alias = *old;
        TACTUS_RETURN_IF_ERROR(CheckEtag(alias, etag));
        if (!CheckServed(alias.previous_version()).ok()) {
          return NothingToRollBack(alias.name());
        }
        alias.mutable_model_version()->swap(*alias.mutable_previous_version());
        // A robot that got the canary gets the restored version too.
        alias.clear_canary();
        v1::AliasChange entry;
        entry.set_model_version(alias.model_version());
        entry.set_time_ms(now_());
        entry.set_requester(caller.name);
        entry.set_rollback(true);
        TACTUS_RETURN_IF_ERROR(PutAlias(change, alias, &entry));
        return Audit(change, caller, now_(), "roll back", alias.name());
      }));
  Serve(alias);
  return alias;
}

absl::StatusOr<std::vector<v1::AliasChange>> ModelStore::History(
    absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed, ParseName(name, kAliases));
  std::vector<v1::AliasChange> changes;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(const auto alias, FindAlias(look, parsed));
        if (!alias.has_value()) return NoAlias(parsed);
        TACTUS_ASSIGN_OR_RETURN(
            changes, ScanRecords<v1::AliasChange>(look, Table::kAliasChanges,
                                                  {.prefix = parsed.id + "/",
                                                   .limit = kMaxHistory,
                                                   .backwards = true}));
        return absl::OkStatus();
      }));
  return changes;
}

}  // namespace tactus::internal::server

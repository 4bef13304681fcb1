// The part of ModelStore that moves aliases.
#include <cstdint>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/store/numbers.h"
#include "core/store/records.h"
#include "server/names/resource_names.h"
#include "server/records/audit_log.h"
#include "server/records/dataset_store.h"
#include "server/records/model_store.h"

namespace tactus::internal::server {
namespace {

constexpr char kAliasesFolder[] = "aliases";
constexpr int kMaxHistory = 1'000;
constexpr uint32_t kMaxPerMille = 1'000;

absl::Status CheckEtag(const v1::Alias& alias, absl::string_view etag) {
  if (etag.empty() || etag == alias.etag()) return absl::OkStatus();
  return EtagMismatch(alias.name(), etag, alias.etag());
}

}  // namespace

absl::StatusOr<std::optional<v1::Alias>> ModelStore::FindAlias(
    const Transaction& look, const ResourceName& name) {
  return GetRecord<v1::Alias>(look, Table::kAliases, name.id);
}

absl::Status ModelStore::NoAlias(const ResourceName& name) {
  return NoSuch(v1::ERROR_REASON_ALIAS_NOT_FOUND, "alias", name.ToString(),
                "trainctl models alias shows those that do");
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
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kAliasesFolder));
  std::optional<v1::Alias> found;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(found, FindAlias(look, parsed));
        return absl::OkStatus();
      }));
  if (!found.has_value()) return NoAlias(parsed);
  return *std::move(found);
}

absl::Status ModelStore::PutAlias(Transaction& change, v1::Alias& alias,
                                  const v1::AliasChange* entry) {
  const std::string id = alias.name().substr(sizeof kAliasesFolder);
  TACTUS_ASSIGN_OR_RETURN(const uint64_t number,
                          NextNumber(change, Table::kAudit));
  // Every change has an entry in the audit log, so its number never repeats.
  alias.set_etag(absl::StrCat(number));
  if (entry != nullptr) {
    TACTUS_RETURN_IF_ERROR(PutRecord(change, Table::kAliasChanges,
                                     absl::StrCat(id, "/", NumberKey(number)),
                                     *entry));
  }
  TACTUS_RETURN_IF_ERROR(CountChange(change));
  return PutRecord(change, Table::kAliases, id, alias);
}

absl::StatusOr<v1::Alias> ModelStore::UpdateAlias(
    const v1::UpdateAliasRequest& wanted, const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName(wanted.name(), kAliasesFolder));
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  TACTUS_RETURN_IF_ERROR(FollowOthers());
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
        TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
        alias = {};
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
  ServeChange(&alias);
  return alias;
}

absl::StatusOr<v1::Alias> ModelStore::Promote(
    const v1::PromoteSpec& spec, bool forced, const Caller& caller,
    absl::FunctionRef<absl::StatusOr<bool>(Transaction&)> also) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName name,
                          ParseName(spec.alias(), kAliasesFolder));
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  TACTUS_RETURN_IF_ERROR(FollowOthers());
  v1::Alias alias;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
        alias = {};
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
  ServeChange(&alias);
  return alias;
}

absl::StatusOr<v1::Alias> ModelStore::Rollback(absl::string_view name,
                                               absl::string_view etag,
                                               const Caller& caller) {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kAliasesFolder));
  TACTUS_ASSIGN_OR_RETURN(const auto lock, data_->locks().Take(kChanges));
  TACTUS_RETURN_IF_ERROR(FollowOthers());
  v1::Alias alias;
  TACTUS_RETURN_IF_ERROR(
      data_->catalog().Change([&](Transaction& change) -> absl::Status {
        TACTUS_RETURN_IF_ERROR(lock->StillHeld(change));
        alias = {};
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
  ServeChange(&alias);
  return alias;
}

absl::StatusOr<std::vector<v1::AliasChange>> ModelStore::History(
    absl::string_view name) const {
  TACTUS_ASSIGN_OR_RETURN(const ResourceName parsed,
                          ParseName(name, kAliasesFolder));
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

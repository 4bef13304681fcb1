// File: model_store.h
//
// ModelStore: model versions and aliases that survive the server. Keeps a
// ModelRegistry in step: what is stored can be found by streams.
//
//   ModelStore models(data, &registry, now);
//   TACTUS_RETURN_IF_ERROR(models.Follow().status());
//   auto version = models.AddVersion("models/grasps", bundle, origin, caller);
//   auto alias = models.Promote(spec, /*forced=*/false, caller);
//
// A version is stored in this order: decode, run the warm-up trial, write the
// bundle as a blob, record the version. Then the registry gets it. An alias
// moves in the catalogue first, then in the registry; streams keep the version
// they began with.
//
// Errors: INVALID_NAME, MODEL_NOT_FOUND, ALIAS_NOT_FOUND, ETAG_MISMATCH, and
// those of storage. Thread-safe. What it is given must outlive it.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/store/data_directory.h"
#include "server/names/resource_names.h"
#include "server/records/caller.h"
#include "server/records/paging.h"
#include "server/records/quotas.h"
#include "server/records/spool.h"
#include "server/registry/model_registry.h"
#include "server/replicas/replica.h"
#include "tactus/v1/models.pb.h"

namespace tactus::internal::server {

class ModelStore {
 public:
  // `replica`: this server among those of its catalogue; null if it is alone.
  ModelStore(DataDirectory* data, ModelRegistry* registry, NowMs now,
             const Quotas& quotas = {}, Replica* replica = nullptr)
      : data_(data),
        registry_(registry),
        now_(std::move(now)),
        quotas_(quotas),
        replica_(replica) {}

  // What Follow has found.
  struct Followed {
    // Number of the last change of versions and aliases.
    uint64_t change = 0;
    // What each alias names is served.
    bool serves_all = true;
  };

  // Brings the registry to what is stored: at the start, and after changes that
  // other servers of the catalogue may have made. Then tells the other servers
  // what this one serves.
  absl::StatusOr<Followed> Follow();
  // False if Follow would find nothing: it has seen the last change, could load
  // all versions and has told the other servers.
  absl::StatusOr<bool> HasNews() const;
  // Versions that the last Follow could not load, each with its error; their
  // aliases are not served.
  std::vector<std::string> failures() const;

  // Makes a bundle the next version of "models/M". The number of a version is
  // never used again, even if the version is deleted. `origin` has the fields
  // that say how it was made. A second call with the same `origin.operation`
  // returns the version of the first. INVALID_NAME if the model is built in;
  // QUOTA_EXCEEDED. Makes none if `job` is no longer held.
  absl::StatusOr<v1::ModelVersion> AddVersion(absl::string_view model,
                                              absl::string_view bundle,
                                              v1::ModelVersion origin,
                                              const Caller& caller,
                                              const Lock* job = nullptr);
  // The same of a bundle that a caller has sent. Decodes one at a time.
  // BUNDLE_CORRUPT also if it has fields that are not known.
  absl::StatusOr<v1::ModelVersion> Import(absl::string_view model,
                                          const Spool& bundle,
                                          const Caller& caller);
  // "models/M/versions/V", "models/M" for the newest version, or "aliases/A".
  // Built-in versions have the fields that the server knows.
  absl::StatusOr<v1::ModelVersion> Get(absl::string_view name) const;
  // The bundle as it was stored; of a built-in version, the same model encoded
  // again. MODEL_NOT_FOUND if the version was deleted since it was found.
  absl::StatusOr<std::string> Bundle(const v1::ModelVersion& version) const;
  // Runs `take` on it in parts of at most limits::kMaxChunkBytes
  // (blob_parts.h).
  absl::Status ReadBundle(
      const v1::ModelVersion& version,
      absl::FunctionRef<absl::Status(absl::string_view)> take) const;
  absl::StatusOr<Page<v1::ModelVersion>> List(
      absl::string_view model, int page_size,
      absl::string_view page_token) const;
  // MODEL_IN_USE.
  absl::Status Delete(absl::string_view name, const Caller& caller);

  absl::StatusOr<std::vector<v1::Alias>> Aliases() const;
  absl::StatusOr<v1::Alias> GetAlias(absl::string_view name) const;
  // Sets canary, gate and shadow of `wanted`. DATASET_NOT_FOUND.
  absl::StatusOr<v1::Alias> UpdateAlias(const v1::UpdateAliasRequest& wanted,
                                        const Caller& caller);
  // Lets the alias name the version, without looking at its gate. `forced` is
  // recorded. Changes nothing, whatever the etag, if the alias names it. `also`
  // joins the transaction, before the alias moves; if it returns false, the
  // alias stays as it is.
  absl::StatusOr<v1::Alias> Promote(
      const v1::PromoteSpec& spec, bool forced, const Caller& caller,
      absl::FunctionRef<absl::StatusOr<bool>(Transaction&)> also =
          [](Transaction&) { return absl::StatusOr<bool>(true); });
  // NOTHING_TO_ROLL_BACK.
  absl::StatusOr<v1::Alias> Rollback(absl::string_view name,
                                     absl::string_view etag,
                                     const Caller& caller);
  // The newest first.
  absl::StatusOr<std::vector<v1::AliasChange>> History(
      absl::string_view name) const;

 private:
  // The lock that is held during changes.
  static constexpr char kChanges[] = "models";

  static absl::StatusOr<std::optional<v1::Alias>> FindAlias(
      const Transaction& look, const ResourceName& name);
  static absl::Status NoAlias(const ResourceName& name);
  // Stores `alias` with a new etag and the entry of its history.
  absl::Status PutAlias(Transaction& change, v1::Alias& alias,
                        const v1::AliasChange* entry);
  // MODEL_NOT_FOUND unless streams can find the version.
  absl::Status CheckServed(absl::string_view version) const;
  void Serve(const v1::Alias& alias);
  // Follow, after a change that was made whatever becomes of this: a server
  // that cannot look now does it with the next news. Then waits for the other
  // servers to serve it, too; `alias` receives those that do not.
  void ServeChange(v1::Alias* alias = nullptr);
  // Before a change that names versions which other servers may have made.
  absl::Status FollowOthers();
  // Counts a change of versions or aliases.
  static absl::Status CountChange(Transaction& change);
  // MODEL_NOT_FOUND if `error` came about because the version was deleted since
  // it was found, else the same error.
  absl::Status Explain(const v1::ModelVersion& version,
                       const absl::Status& error) const;

  DataDirectory* const data_;
  ModelRegistry* const registry_;
  const NowMs now_;
  const Quotas quotas_;
  Replica* const replica_;
  // Held while an imported bundle is in memory.
  std::mutex importing_;
  // Held while the registry follows, so that it never goes back.
  mutable std::mutex following_;
  std::vector<std::string> failures_;
  // The change that it has reached; none before the first time, and while a
  // version cannot be read or the others do not know.
  std::optional<uint64_t> followed_;
};

}  // namespace tactus::internal::server

#include "server/jobs/training_backend.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "core/base/status_macros.h"
#include "core/base/version.h"
#include "core/store/file_system.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
namespace {

// In case that a job could not be taken when its server was gone, because the
// database was away.
constexpr int kBeatsPerLook = 10;

// What follows the slash of a replica's name.
std::string IdOf(const std::string& name) {
  return name.substr(name.find('/') + 1);
}

}  // namespace

absl::StatusOr<TrainingBackend::Parts> TrainingBackend::OpenParts(
    const Options& options) {
  Parts parts;
  if (options.shared.catalog.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        parts.data, DataDirectory::Open(PosixFileSystem(), options.folder));
    return parts;
  }
  TACTUS_ASSIGN_OR_RETURN(parts.catalog,
                          OpenPostgresCatalog(options.shared.catalog));
  v1::StoredReplica about;
  about.set_host(options.jobs.host);
  about.set_address(options.shared.address);
  about.set_version(kVersion);
  about.set_start_time_ms(options.now ? options.now() : SystemNowMs());
  TACTUS_ASSIGN_OR_RETURN(
      parts.replica,
      Replica::Register(parts.catalog.get(), about, options.shared.pace));
  parts.locks =
      std::make_unique<SharedLocks>(parts.catalog.get(), parts.replica.get());
  TACTUS_ASSIGN_OR_RETURN(
      parts.data,
      DataDirectory::OpenShared(PosixFileSystem(), options.folder,
                                IdOf(parts.replica->name()),
                                parts.catalog.get(), parts.locks.get()));
  if (options.shared.blob_cache_bytes > 0) {
    const std::string& own = options.shared.own_folder;
    TACTUS_RETURN_IF_ERROR(PosixFileSystem().MakeDirectory(own));
    TACTUS_ASSIGN_OR_RETURN(
        auto cache, BlobCache::Open(PosixFileSystem(), own + "/blob-cache",
                                    options.shared.blob_cache_bytes));
    parts.data->blobs().UseCache(std::move(cache));
  }
  return parts;
}

absl::StatusOr<std::unique_ptr<TrainingBackend>> TrainingBackend::Open(
    const Options& options, ModelRegistry* registry) {
  TACTUS_ASSIGN_OR_RETURN(Parts parts, OpenParts(options));
  std::unique_ptr<TrainingBackend> backend(
      new TrainingBackend(std::move(parts), options, registry));
  if (backend->data().catalog_is_older()) {
    spdlog::warn(
        "{}: the catalogue is older than the directory: it is a copy, or its "
        "last changes were lost. What was stored since is in no record; "
        "trainctl doctor finds it and moves it to lost+found",
        options.folder);
  }
  if (backend->replica() == nullptr) {
    TACTUS_RETURN_IF_ERROR(backend->operations_.Restore());
  }
  TACTUS_RETURN_IF_ERROR(backend->FollowModels());
  return backend;
}

TrainingBackend::TrainingBackend(Parts parts, const Options& options,
                                 ModelRegistry* registry)
    : now_(options.now ? options.now : SystemNowMs),
      parts_(std::move(parts)),
      catalog_(options.shared.catalog),
      runs_jobs_(options.runs_jobs),
      quotas_(options.quotas),
      sweep_interval_(options.sweep_interval_ms),
      datasets_(parts_.data.get(), now_, quotas_),
      uploads_(parts_.data.get(), &datasets_, now_, quotas_),
      operations_(parts_.data.get(), now_, quotas_, options.retention),
      models_(parts_.data.get(), registry, now_, quotas_, parts_.replica.get()),
      jobs_(parts_.data.get(), &datasets_, &models_, &operations_, options.jobs,
            now_) {}

TrainingBackend::~TrainingBackend() {
  Stop();
  LogCache();
}

void TrainingBackend::Start() {
  Sweep();
  sweeper_ = std::thread([this] {
    std::unique_lock lock(mutex_);
    while (!wake_.wait_for(lock, sweep_interval_, [&] { return stopping_; })) {
      lock.unlock();
      Sweep();
      lock.lock();
    }
  });
  if (runs_jobs_) jobs_.Start();
  if (replica() == nullptr) return;
  // A job whose server has died is no news of the catalogue. A look reads all
  // jobs, so it is not made at each beat.
  replica()->Start([this, beats = 0](bool gone) mutable {
    parts_.locks->ReleaseAgain();
    if (++beats % kBeatsPerLook == 0 || gone) jobs_.Wake();
  });
  news_ = std::make_unique<CatalogNews>(
      catalog_, [this](bool of_replicas) { OnNews(of_replicas); });
}

void TrainingBackend::OnNews(bool of_replicas) {
  replica()->OnNews();
  // Nothing else has changed, and each promotion brings one of each server.
  if (of_replicas) return;
  operations_.OnNews();
  jobs_.Wake();
  if (const absl::Status followed = FollowModels(); !followed.ok()) {
    spdlog::warn("models: {}", followed.ToString());
  }
}

absl::Status TrainingBackend::FollowModels() {
  // Most news is of other things.
  TACTUS_ASSIGN_OR_RETURN(const bool changed, models_.HasNews());
  if (!changed) return absl::OkStatus();
  return models_.Follow().status();
}

absl::Status TrainingBackend::SweepShared() {
  TACTUS_RETURN_IF_ERROR(replica()->ForgetDead());
  // Asked anew for each: a server may just have begun.
  const auto is_alive = [&](const std::string& id) {
    const auto replicas = replica()->All();
    return !replicas.ok() ||
           std::ranges::any_of(*replicas, [&](const Replica::Seen& seen) {
             return seen.alive && IdOf(seen.about.name()) == id;
           });
  };
  return data().blobs().Sweep(now_(), is_alive, [&](const std::string& sha256) {
    return datasets_.IsUsed(sha256);
  });
}

void TrainingBackend::Sweep() {
  const auto removed = uploads_.RemoveAbandoned();
  if (!removed.ok()) {
    spdlog::error("abandoned uploads: {}", removed.status().ToString());
  } else if (*removed > 0) {
    spdlog::info("removed {} abandoned uploads", *removed);
  }
  const auto old = operations_.RemoveOld();
  if (!old.ok()) {
    spdlog::error("old jobs: {}", old.status().ToString());
  } else if (*old > 0) {
    spdlog::info("removed {} old jobs", *old);
  }
  if (replica() == nullptr) return;
  if (const absl::Status swept = SweepShared(); !swept.ok()) {
    spdlog::error("removed blobs: {}", swept.ToString());
  }
}

void TrainingBackend::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    wake_.notify_all();
  }
  news_.reset();
  if (replica() != nullptr) replica()->Stop();
  if (sweeper_.joinable()) sweeper_.join();
  operations_.StopWaiting();
  jobs_.Stop();
}

void TrainingBackend::LogCache() {
  const BlobCache* const cache = data().blobs().cache();
  if (cache == nullptr) return;
  const BlobCache::Totals totals = cache->totals();
  spdlog::info(
      "blob cache: {} reads found their blob and {} did not, {} copies were "
      "damaged and {} made room; {} blobs of {} bytes are there",
      totals.found, totals.missing, totals.damaged, totals.evicted,
      totals.blobs, totals.bytes);
}

}  // namespace tactus::internal::server

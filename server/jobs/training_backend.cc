#include "server/jobs/training_backend.h"

#include <mutex>
#include <utility>

#include "core/base/status_macros.h"
#include "core/store/file_system.h"
#include "spdlog/spdlog.h"

namespace tactus::internal::server {
absl::StatusOr<std::unique_ptr<TrainingBackend>> TrainingBackend::Open(
    const Options& options, ModelRegistry* registry) {
  TACTUS_ASSIGN_OR_RETURN(
      auto data, DataDirectory::Open(PosixFileSystem(), options.folder));
  std::unique_ptr<TrainingBackend> backend(
      new TrainingBackend(std::move(data), options, registry));
  if (backend->data_->catalog_is_older()) {
    spdlog::warn(
        "{}: catalog.db is older than the directory: it is a copy, or its "
        "write-ahead log was lost. What was stored since is in no record; "
        "trainctl doctor finds it and moves it to lost+found",
        options.folder);
  }
  TACTUS_RETURN_IF_ERROR(backend->operations_.Restore());
  TACTUS_ASSIGN_OR_RETURN(backend->failures_, backend->models_.Restore());
  return backend;
}

TrainingBackend::TrainingBackend(std::unique_ptr<DataDirectory> data,
                                 const Options& options,
                                 ModelRegistry* registry)
    : now_(options.now ? options.now : SystemNowMs),
      data_(std::move(data)),
      quotas_(options.quotas),
      sweep_interval_(options.sweep_interval_ms),
      datasets_(data_.get(), now_, quotas_),
      uploads_(data_.get(), &datasets_, now_, quotas_),
      operations_(data_.get(), now_, quotas_, options.retention),
      models_(data_.get(), registry, now_, quotas_),
      jobs_(data_.get(), &datasets_, &models_, &operations_, options.jobs,
            now_) {}

TrainingBackend::~TrainingBackend() { Stop(); }

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
  jobs_.Start();
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
}

void TrainingBackend::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    wake_.notify_all();
  }
  if (sweeper_.joinable()) sweeper_.join();
  operations_.StopWaiting();
  jobs_.Stop();
}

}  // namespace tactus::internal::server

#include "server/jobs/training_backend.h"

#include <chrono>
#include <utility>

#include "core/base/status_macros.h"
#include "core/store/file_system.h"

namespace tactus::server {
namespace {

int64_t SystemNowMs() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace

absl::StatusOr<std::unique_ptr<TrainingBackend>> TrainingBackend::Open(
    const Options& options, ModelRegistry* registry) {
  TACTUS_ASSIGN_OR_RETURN(
      auto data, DataDirectory::Open(PosixFileSystem(), options.folder));
  std::unique_ptr<TrainingBackend> backend(
      new TrainingBackend(std::move(data), options, registry));
  TACTUS_RETURN_IF_ERROR(backend->operations_.Restore());
  TACTUS_ASSIGN_OR_RETURN(backend->failures_, backend->models_.Restore());
  return backend;
}

TrainingBackend::TrainingBackend(std::unique_ptr<DataDirectory> data,
                                 const Options& options,
                                 ModelRegistry* registry)
    : now_(options.now ? options.now : SystemNowMs),
      data_(std::move(data)),
      datasets_(data_.get(), now_),
      uploads_(data_.get(), &datasets_, now_),
      operations_(data_.get(), now_),
      models_(data_.get(), registry, now_),
      jobs_(data_.get(), &datasets_, &models_, &operations_, options.jobs,
            now_) {}

void TrainingBackend::Stop() {
  operations_.StopWaiting();
  jobs_.Stop();
}

}  // namespace tactus::server

#include "client/drivers/replay_driver.h"

#include <algorithm>
#include <mutex>
#include <utility>

#include "core/base/status_macros.h"

namespace tactus::internal::client {
namespace {

// The serial HDF5 library may be used by one thread at a time.
std::mutex& Hdf5Mutex() {
  static auto* const mutex = new std::mutex();
  return *mutex;
}

}  // namespace

ReplayDriver::ReplayDriver(std::string path, const Shard& shard,
                           const Options& options)
    : TrialDriver(shard, 0, options.layout),
      path_(std::move(path)),
      max_trials_(options.max_trials) {}

ReplayDriver::~ReplayDriver() {
  const std::lock_guard lock(Hdf5Mutex());
  reader_.reset();
}

absl::StatusOr<SkinInfo> ReplayDriver::OnConfigure() {
  {
    const std::lock_guard lock(Hdf5Mutex());
    TACTUS_ASSIGN_OR_RETURN(reader_, TrialFileReader::Open(path_));
    const size_t size = reader_->size();
    set_count(max_trials_ == 0 ? size : std::min(size, max_trials_));
  }
  return TrialDriver::OnConfigure();
}

absl::StatusOr<Trial> ReplayDriver::MakeTrial(size_t index) {
  const std::lock_guard lock(Hdf5Mutex());
  return reader_->Read(index);
}

}  // namespace tactus::internal::client

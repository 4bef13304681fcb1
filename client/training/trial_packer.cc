#include "client/training/trial_packer.h"

#include <utility>

#include "core/base/crc32c.h"
#include "core/base/status_macros.h"
#include "core/data/trial_pack.h"
#include "core/data/trial_record.h"

namespace tactus::internal::client {

TrialPacker::TrialPacker(const NextTrial& next_trial, Options options)
    : next_trial_(next_trial), options_(options), thread_([this] { Run(); }) {}

TrialPacker::~TrialPacker() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
    changed_.notify_all();
  }
  thread_.join();
}

absl::StatusOr<PackChunk> TrialPacker::Next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !ready_.empty(); });
  // The end and an error are never taken away.
  const bool chunks = ready_.front().ok() && !ready_.front()->data.empty();
  if (!chunks) {
    ended_ = ready_.front().ok();
    return ready_.front();
  }
  PackChunk chunk = *std::move(ready_.front());
  ready_.pop_front();
  ready_bytes_ -= chunk.data.size();
  changed_.notify_all();
  lock.unlock();
  size_ += static_cast<int64_t>(chunk.data.size());
  crc32c_ = ExtendCrc32c(crc32c_, chunk.data);
  trials_ = chunk.trials;
  return chunk;
}

void TrialPacker::Run() {
  while (true) {
    absl::StatusOr<PackChunk> chunk = Make();
    const bool more = chunk.ok() && !chunk->data.empty();
    if (!Hand(std::move(chunk)) || !more) return;
  }
}

absl::StatusOr<PackChunk> TrialPacker::Make() {
  while (pending_.size() - taken_ < options_.chunk_bytes && !last_) {
    TACTUS_ASSIGN_OR_RETURN(const std::optional<Trial> trial, next_trial_());
    if (!trial) {
      last_ = true;
      break;
    }
    pending_.erase(0, std::exchange(taken_, 0));
    TACTUS_RETURN_IF_ERROR(AppendToPack(ToRecord(*trial), &pending_));
    ++packed_;
  }
  PackChunk chunk = {offset_, pending_.substr(taken_, options_.chunk_bytes),
                     packed_};
  taken_ += chunk.data.size();
  offset_ += static_cast<int64_t>(chunk.data.size());
  return chunk;
}

bool TrialPacker::Hand(absl::StatusOr<PackChunk> chunk) {
  std::unique_lock lock(mutex_);
  ready_bytes_ += chunk.ok() ? chunk->data.size() : 0;
  ready_.push_back(std::move(chunk));
  changed_.notify_all();
  changed_.wait(lock, [this] {
    return stopping_ || ready_.empty() || ready_bytes_ < options_.ahead_bytes;
  });
  return !stopping_;
}

}  // namespace tactus::internal::client

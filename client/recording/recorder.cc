#include "client/recording/recorder.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace tactus::client {
namespace {

// An open chunk is closed after this time without events.
constexpr std::chrono::seconds kIdle(1);

// What an event costs beside its bytes.
constexpr size_t kEntryBytes = 512;

}  // namespace

absl::StatusOr<std::unique_ptr<Recorder>> Recorder::Create(
    const std::string& path, const Options& options) {
  TACTUS_ASSIGN_OR_RETURN(
      auto writer,
      RecordingWriter::Create(path, options.about, {.sync = options.sync}));
  return std::unique_ptr<Recorder>(new Recorder(std::move(writer), options));
}

Recorder::Recorder(std::unique_ptr<RecordingWriter> writer,
                   const Options& options)
    : writer_(std::move(writer)), options_(options) {
  thread_ = std::thread([this] { WriteAll(); });
}

Recorder::~Recorder() { Finish().IgnoreError(); }

void Recorder::Begin(const SkinInfo& info, const v1::StreamConfig& config,
                     const v1::StreamStarted& started) {
  encoder_.emplace(info, FrameEncoder::Options{});
  model_ = {{"model_version", started.model_version()},
            {"bundle_sha256", started.bundle_sha256()},
            {"client_id", config.client_id()}};
  Push(config, config.ByteSizeLong(), /*must=*/true);
  Push(started, started.ByteSizeLong(), /*must=*/true);
}

void Recorder::BeginTrial(RecordingTexts values) {
  values.insert(model_.begin(), model_.end());
  values.insert(options_.about.begin(), options_.about.end());
  values["first_sequence"] = absl::StrCat(encoder_->last_sequence() + 1);
  Push(RecordedTrial{std::move(values)}, 0, /*must=*/true);
}

void Recorder::Frame(const SkinFrame& frame) {
  encoder_->Skip(frame.missing_before);
  encoder_->Add(frame);
  const v1::FrameBatch& batch = encoder_->request().frames();
  const bool kept = Push(batch, encoder_->bytes(), /*must=*/false);
  encoder_->Clear();
  const std::lock_guard lock(mutex_);
  ++(kept ? totals_.frames : totals_.lost_frames);
}

void Recorder::EndTrial() { Push(v1::EndOfTrial(), 0, /*must=*/true); }

void Recorder::Result(const v1::Posterior& posterior) {
  const bool kept = Push(posterior, posterior.ByteSizeLong(), /*must=*/false);
  const std::lock_guard lock(mutex_);
  ++(kept ? totals_.results : totals_.lost_results);
}

bool Recorder::Push(RecordingEvent event, size_t bytes, bool must) {
  bytes += kEntryBytes;
  std::unique_lock lock(mutex_);
  const auto has_room = [&] {
    return queue_.empty() || queued_bytes_ + bytes <= options_.queue_bytes;
  };
  if (!must && options_.wait_when_full) {
    changed_.wait(lock, [&] { return has_room() || stop_ || !status_.ok(); });
  }
  if (stop_ || !status_.ok() || (!must && !has_room())) return false;
  queued_bytes_ += bytes;
  queue_.push_back({std::move(event), bytes});
  changed_.notify_all();
  return true;
}

void Recorder::WriteAll() {
  bool flushed = true;
  std::unique_lock lock(mutex_);
  while (true) {
    const bool woken = changed_.wait_for(
        lock, kIdle, [this] { return stop_ || !queue_.empty(); });
    if (queue_.empty() && stop_) return;
    absl::Status status;
    if (woken) {
      const Entry entry = std::move(queue_.front());
      queue_.pop_front();
      lock.unlock();
      status = writer_->Write(entry.event);
      lock.lock();
      queued_bytes_ -= entry.bytes;
      flushed = false;
      changed_.notify_all();
    } else if (!flushed) {
      lock.unlock();
      status = writer_->Flush();
      lock.lock();
      flushed = true;
    }
    if (status.ok()) continue;
    // Nothing can be written any more: what waits is lost.
    status_ = status;
    for (const Entry& entry : queue_) {
      if (std::holds_alternative<v1::FrameBatch>(entry.event)) {
        ++totals_.lost_frames;
        --totals_.frames;
      } else if (std::holds_alternative<v1::Posterior>(entry.event)) {
        ++totals_.lost_results;
        --totals_.results;
      }
    }
    queue_.clear();
    queued_bytes_ = 0;
    changed_.notify_all();
    return;
  }
}

absl::Status Recorder::Finish() {
  if (finished_) return status_;
  finished_ = true;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    changed_.notify_all();
  }
  thread_.join();
  if (!status_.ok()) return status_;
  status_ =
      writer_->Finish({{"frames", absl::StrCat(totals_.frames)},
                       {"lost_frames", absl::StrCat(totals_.lost_frames)},
                       {"results", absl::StrCat(totals_.results)},
                       {"lost_results", absl::StrCat(totals_.lost_results)}});
  return status_;
}

}  // namespace tactus::client

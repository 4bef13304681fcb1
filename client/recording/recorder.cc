#include "client/recording/recorder.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/status_macros.h"

namespace tactus::internal::client {
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

void Recorder::BeginRaw(const SkinInfo& raw_info,
                        std::string calibration_json) {
  SkinInfo info = raw_info;
  // Poses are those of the frames.
  info.with_poses = false;
  raw_encoder_.emplace(info, FrameEncoder::Options{});
  const size_t bytes = calibration_json.size();
  Push(RecordedCalibration{MakeConfig(info), std::move(calibration_json)},
       bytes, /*must=*/true);
}

void Recorder::BeginTrial(RecordingTexts values) {
  values.insert(model_.begin(), model_.end());
  values.insert(options_.about.begin(), options_.about.end());
  values["first_sequence"] = absl::StrCat(encoder_->last_sequence() + 1);
  Push(RecordedTrial{std::move(values)}, 0, /*must=*/true);
}

void Recorder::BeginTrial(const LabelledDriver& driver) {
  const Trial& trial = driver.trial();
  BeginTrial({{"id", trial.id},
              {"index", absl::StrCat(driver.trial_index())},
              {"label", trial.label},
              {"condition", trial.condition},
              {"object", trial.object},
              {"material", trial.material}});
}

void Recorder::Frame(const SkinFrame& frame, const SkinFrame* raw) {
  encoder_->Skip(frame.missing_before);
  encoder_->Add(frame);
  size_t bytes = encoder_->bytes();
  std::optional<RawFrame> raw_frame;
  if (raw_encoder_) {
    raw_encoder_->Skip(frame.missing_before);
    raw_encoder_->Add(*raw);
    bytes += raw_encoder_->bytes();
    raw_frame = {raw_encoder_->request().frames()};
    raw_encoder_->Clear();
  }
  const bool kept = Push(encoder_->request().frames(), bytes, /*must=*/false,
                         std::move(raw_frame));
  encoder_->Clear();
  const std::lock_guard lock(mutex_);
  ++(kept ? totals_.frames : totals_.lost_frames);
}

void Recorder::EndTrial() { Push(v1::EndOfTrial(), 0, /*must=*/true); }

void Recorder::Result(const v1::Answer& answer) {
  const bool kept = Push(answer, answer.ByteSizeLong(), /*must=*/false);
  const std::lock_guard lock(mutex_);
  ++(kept ? totals_.results : totals_.lost_results);
}

bool Recorder::Push(RecordingEvent event, size_t bytes, bool must,
                    std::optional<RawFrame> raw) {
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
  queue_.push_back({std::move(event), std::move(raw), bytes});
  changed_.notify_all();
  return true;
}

absl::Status Recorder::Write(const Entry& entry) {
  TACTUS_RETURN_IF_ERROR(writer_->Write(entry.event));
  return entry.raw ? writer_->Write(*entry.raw) : absl::OkStatus();
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
      status = Write(entry);
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
      } else if (std::holds_alternative<v1::Answer>(entry.event)) {
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
  if (finished_) return final_status_;
  finished_ = true;
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    changed_.notify_all();
  }
  thread_.join();
  {
    // Results may still come; they are too late for the file.
    const std::lock_guard lock(mutex_);
    final_totals_ = totals_;
    final_status_ = status_;
  }
  if (!final_status_.ok()) return final_status_;
  const Totals& totals = final_totals_;
  final_status_ =
      writer_->Finish({{"frames", absl::StrCat(totals.frames)},
                       {"lost_frames", absl::StrCat(totals.lost_frames)},
                       {"results", absl::StrCat(totals.results)},
                       {"lost_results", absl::StrCat(totals.lost_results)}});
  return final_status_;
}

}  // namespace tactus::internal::client

// File: recorded_streams.h
//
// Streams with a recorder, without a server and without a disk, and what was
// recorded of them.
//
//   RecordedStreamRig rig(config, SmallPinned());
//   rig.Send(batch);
//   rig.EndStream();
//   rig.sink().kept.at(0).stored.contacts(0).label();
//
// Test-only. Not thread-safe.
#pragma once

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/stream/contact_session.h"
#include "core/stream/stream_settings.h"
#include "core/stream/stream_started.h"
#include "gtest/gtest.h"
#include "server/contact_log/contact_facts.h"
#include "server/contact_log/contact_recorder.h"
#include "server/session/model_source.h"
#include "tests/support/small_model.h"

namespace tactus::internal::server {

// 14 November 2023, when the first message of a stream comes.
inline constexpr int64_t kFirstMessageMs = 1'700'000'000'000;

inline PinnedModel Pinned(const Model& model) {
  return {*CompiledModel::Create(model), "models/default/versions/1",
          std::string(64, 'a')};
}

inline PinnedModel SmallPinned(double rate_hz = 100) {
  Model model = testing::SmallModel();
  model.inputs.sample_rate_hz = rate_hz;
  return Pinned(model);
}

// Keeps all recordings, and gives their chunks back at once.
class KeptRecordings final : public RecordingSink {
 public:
  struct Kept {
    v1::StoredContacts stored;
    v1::Recording recording;
    bool cut = false;
    bool exact = false;
  };

  explicit KeptRecordings(ChunkPool* pool) : pool_(pool) {}

  bool TryTake(FinishedRecording& recording) override {
    if (busy) {
      ++refused;
      return false;
    }
    Keep(recording);
    return true;
  }
  void Take(FinishedRecording& recording) override { Keep(recording); }
  void OnLeftOut() override { ++left_out; }

  std::vector<Kept> kept;
  int left_out = 0;
  // TryTake refuses.
  bool busy = false;
  int refused = 0;

 private:
  void Keep(FinishedRecording recording) {
    Kept& out = kept.emplace_back();
    auto stored = StoreRecording(recording, *pool_);
    EXPECT_TRUE(stored.ok()) << stored.status();
    if (stored.ok()) out.stored = *std::move(stored);
    EXPECT_TRUE(out.recording.ParseFromString(recording.Join(*pool_)));
    out.cut = recording.cut;
    out.exact = recording.exact;
    recording.GiveBack(*pool_);
  }

  ChunkPool* const pool_;
};

// The robot's answers, in the order in which they came.
class RobotAnswers final : public AnswerSink {
 public:
  v1::Answer* AddInterim() override { return &answers_.emplace_back(); }
  v1::Answer* AddKept() override { return &answers_.emplace_back(); }
  v1::StreamNotice* AddNotice() override { return &notice_; }
  const std::deque<v1::Answer>& answers() const { return answers_; }

 private:
  std::deque<v1::Answer> answers_;
  v1::StreamNotice notice_;
};

class RecordedStreamRig {
 public:
  explicit RecordedStreamRig(const v1::StreamConfig& config,
                             const PinnedModel& model = SmallPinned(),
                             size_t chunks = 100, bool with_recorder = true)
      : chunks_(chunks), pool_(chunks), sink_(&pool_) {
    const StreamSettings settings = *ParseStreamConfig(config);
    session_ =
        std::make_unique<ContactSession>(settings, model.model, &answers_);
    if (!with_recorder) return;
    auto stream = std::make_shared<v1::RecordedStream>();
    *stream->mutable_config() = config;
    WriteStarted(settings, *model.model, stream->mutable_started());
    stream->mutable_started()->set_model_version(model.version_name);
    stream->mutable_started()->set_bundle_sha256(model.sha256);
    stream->mutable_started()->set_stream_id("7");
    stream->set_caller("caller");
    stream->set_peer("peer");
    recorder_ = std::make_unique<ContactRecorder>(&pool_, &sink_, stream);
    session_->SetTap(recorder_.get());
  }

  // As the server calls them.
  void Send(const v1::FrameBatch& batch) {
    const absl::Status status = session_->OnFrames(batch);
    ASSERT_TRUE(status.ok()) << status;
    const int64_t last = batch.frame_count() - 1;
    last_ns_ = batch.first_capture_time_ns() + last * period_ns_;
    if (recorder_ != nullptr) recorder_->EndMessage(&batch, now_ms());
  }
  void EndTrial() {
    session_->OnEndOfTrial();
    if (recorder_ != nullptr) recorder_->EndMessage(nullptr, now_ms());
  }
  // The robot's half-close, which ends an open trial.
  void EndStream() {
    if (session_->trial_open()) session_->OnEndOfTrial();
    Break();
  }
  // The connection is gone.
  void Break() {
    if (recorder_ != nullptr) recorder_->EndStream(now_ms());
  }
  // Destroys the recorder.
  void Drop() {
    session_->SetTap(nullptr);
    recorder_.reset();
  }

  // The clock of the server when the last message came.

  int64_t now_ms() const { return kFirstMessageMs + last_ns_ / 1'000'000; }
  void set_period_ns(int64_t period_ns) { period_ns_ = period_ns; }
  // Chunks that somebody has.
  size_t taken_chunks() const { return chunks_ - pool_.free(); }
  ChunkPool& pool() { return pool_; }
  KeptRecordings& sink() { return sink_; }
  ContactSession& session() { return *session_; }
  const RobotAnswers& robot() const { return answers_; }

 private:
  const size_t chunks_;
  ChunkPool pool_;
  KeptRecordings sink_;
  RobotAnswers answers_;
  std::unique_ptr<ContactSession> session_;
  std::unique_ptr<ContactRecorder> recorder_;
  int64_t period_ns_ = 10'000'000;
  int64_t last_ns_ = 0;
};

}  // namespace tactus::internal::server

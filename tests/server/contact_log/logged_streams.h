// File: logged_streams.h
//
// Robots whose contacts go to a ContactLog.
//
//   LoggedStream stream(*log, "arm");
//   stream.Contact(30);
//   log->Flush();
//
// Test-only. Not thread-safe: one per thread.
#pragma once

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "server/contact_log/contact_log.h"
#include "tests/server/contact_log/pressed_stream.h"

namespace tactus::internal::server {

inline const PinnedModel& LoggedModel() {
  static const PinnedModel model = SmallPinned();
  return model;
}

class LoggedStream {
 public:
  explicit LoggedStream(ContactLog& log, const std::string& robot = "arm") {
    v1::StreamConfig config = PressedConfig();
    config.set_taxel_type(v1::TAXEL_TYPE_FLOAT32);
    config.clear_scale();
    config.set_client_id(robot);
    const StreamSettings settings = *ParseStreamConfig(config);
    session_ = std::make_unique<ContactSession>(settings, LoggedModel().model,
                                                &answers_);
    v1::RecordedStream stream;
    *stream.mutable_config() = config;
    WriteStarted(settings, *LoggedModel().model, stream.mutable_started());
    stream.mutable_started()->set_model_version(LoggedModel().version_name);
    stream.mutable_started()->set_bundle_sha256(LoggedModel().sha256);
    recorder_ = log.Record(std::move(stream));
    session_->SetTap(recorder_.get());
  }
  ~LoggedStream() { recorder_->EndStream(now_ms()); }

  // A trial with one contact of so many frames. Noise that nobody feels makes
  // its record as large as its frames.
  void Contact(int frames, bool with_noise = false) {
    for (int t = 0; t < frames + 2; ++t) {
      auto request = testing::DenseF32(
          next_++, {t < 2 ? testing::Untouched() : PressedAt(5, 7)});
      v1::FrameBatch& batch = *request.mutable_frames();
      if (with_noise) AddNoise(*batch.mutable_taxels());
      if (!session_->OnFrames(batch).ok()) ADD_FAILURE() << next_;
      recorder_->EndMessage(&batch, now_ms());
    }
    session_->OnEndOfTrial();
    recorder_->EndMessage(nullptr, now_ms());
  }

 private:
  class Nobody final : public AnswerSink {
   public:
    v1::Answer* AddInterim() override { return &answer_; }
    v1::Answer* AddKept() override { return &answer_; }
    v1::StreamNotice* AddNotice() override { return &notice_; }

   private:
    v1::Answer answer_;
    v1::StreamNotice notice_;
  };

  int64_t now_ms() const {
    return kFirstMessageMs + 10 * static_cast<int64_t>(next_);
  }
  void AddNoise(std::string& taxels) {
    for (size_t at = 0; at < taxels.size(); at += sizeof(float)) {
      float value = 0;
      std::memcpy(&value, taxels.data() + at, sizeof value);
      value += static_cast<float>(random_.Uniform(0, 0.009));
      std::memcpy(taxels.data() + at, &value, sizeof value);
    }
  }

  Random random_{23};
  Nobody answers_;
  std::unique_ptr<ContactSession> session_;
  std::unique_ptr<ContactRecorder> recorder_;
  uint64_t next_ = 1;
};

}  // namespace tactus::internal::server

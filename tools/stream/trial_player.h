// File: trial_player.h
//
// TrialPlayer: plays the trials of a driver over one stream, as a robot would,
// and records the answers, their delays and lost frames.
//
//   TrialPlayer player(channel, &driver, {.real_time = true},
//                      [](const TrialResult& result) { Print(result); });
//   TACTUS_RETURN_IF_ERROR(player.Run());
//   Print(player.totals());
//
// Each player belongs to one thread, on which `on_trial` is called. Players on
// several threads may share a channel.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/drivers/labelled_driver.h"
#include "client/recording/answer_check.h"
#include "client/recording/recorder.h"
#include "client/stream/frame_encoder.h"
#include "client/stream/resumable_stream.h"
#include "grpcpp/channel.h"

namespace tactus::internal::client {

// The final answer for one trial.
struct TrialResult {
  size_t index = 0;
  std::string id;
  // Indices into the class names.
  int label = 0;
  int answer = 0;
  // False if the skin never reported a contact. The other fields mean nothing
  // then.
  bool detected = false;
  std::vector<double> probability;
  std::vector<double> log_likelihood;
  // The decision's class and time since onset, if a decision was reached.
  std::optional<int> decision;
  double decision_ms = 0;
};

class TrialPlayer {
 public:
  struct Options {
    std::string model = {};
    bool sparse = false;
    // Frames per message.
    uint32_t batch = 1;
    // True: frames leave at their capture times. False: each message leaves
    // as soon as the one before is answered.
    bool real_time = false;
    // `final_answer` also bounds the wait for the answer to a message.
    StreamTimeouts timeouts = {};
    // How long a lost stream may take to go on (resumable_stream.h); 0: a loss
    // is an error.
    std::chrono::milliseconds resume_for{0};
    // The robot's bearer token; empty: none.
    std::string token = {};
    // Names the robot to the server, and to a proxy (robot_id.h).
    std::string client_id = {};
    // If set, what the driver returns and what the server answers is recorded.
    Recorder* recorder = nullptr;
    // If set, gets the server's answers.
    AnswerCheck* check = nullptr;
  };
  struct Totals {
    uint64_t frames = 0;
    // Frames that were neither answered nor superseded by newer answers.
    uint64_t lost = 0;
    // How often a lost stream was resumed.
    uint64_t resumed = 0;
    // For each message, the time from sending it to the answer to its last
    // frame.
    std::vector<double> rtt_us;
    // What users read if the trials' times are those of another rate than
    // theirs; else empty.
    std::string rate_news = {};
    // The same if the skin reads unlike in training.
    std::string skin_news = {};
  };
  using OnTrial = std::function<void(const TrialResult&)>;

  // `driver` is unconfigured and outlives the player.
  TrialPlayer(std::shared_ptr<grpc::Channel> channel, LabelledDriver* driver,
              const Options& options, OnTrial on_trial);

  // Plays all trials; opens no stream if there are none. INVALID_CONFIG for a
  // label that is no class of the model, and for trials of another skin than
  // the model's.
  absl::Status Run();

  const Totals& totals() const { return totals_; }
  // Valid after Run.
  const std::vector<std::string>& class_names() const { return class_names_; }

 private:
  absl::Status Play();
  absl::Status PlayFrame(const SkinFrame& frame);
  void BeginTrial(const SkinFrame& frame);
  absl::Status SendBatch();
  absl::Status EndTrial();
  absl::StatusOr<TrialResult> Result(const v1::Answer& answer) const;
  void OnResponse(const v1::ClassifyContactResponse& response);
  // Waits for the answer to frame `sequence`, or the stream's end.
  absl::Status AwaitAnswer(uint64_t sequence);

  const std::shared_ptr<grpc::Channel> channel_;
  LabelledDriver* const driver_;
  const Options options_;
  const OnTrial on_trial_;
  std::unique_ptr<ResumableStream> stream_;
  std::optional<FrameEncoder> encoder_;
  std::vector<std::string> class_names_;
  // The running trial: when its first frame was due and captured.
  bool in_trial_ = false;
  int64_t trial_start_ns_ = 0;
  int64_t trial_capture_ns_ = 0;
  Totals totals_;

  // Shared with the stream's reading thread.
  std::mutex mutex_;
  std::condition_variable answered_;
  int64_t sent_ns_ = 0;
  uint64_t sent_sequence_ = 0;
  uint64_t last_answer_ = 0;
  uint64_t answers_ = 0;
  std::vector<double> rtt_us_;
};

}  // namespace tactus::internal::client

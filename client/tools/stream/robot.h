// File: robot.h
//
// Robot: plays the trials of a driver over one stream and notes the answers,
// their delays and what got lost.
//
//   Robot robot(channel, &driver, {.real_time = true}, on_trial);
//   TACTUS_RETURN_IF_ERROR(robot.Run());
//   robot.totals().rtt_us;
//
// Each robot belongs to one thread; robots on several threads may share a
// channel. `on_trial` is called on the robot's thread.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/drivers/trial_driver.h"
#include "client/stream/contact_stream.h"
#include "client/stream/frame_encoder.h"
#include "grpcpp/channel.h"

namespace tactus::client {

// The final answer to one trial.
struct TrialResult {
  size_t index = 0;
  std::string id;
  // Indices into the class names.
  int label = 0;
  int answer = 0;
  // False if the skin never reported a contact; the rest says nothing then.
  bool detected = false;
  std::vector<double> probability;
  std::vector<double> log_likelihood;
  // If a decision was reached: its class and when, since onset.
  std::optional<int> decision;
  double decision_ms = 0;
};

class Robot {
 public:
  struct Options {
    std::string model;
    bool sparse = false;
    // Frames a message.
    uint32_t batch = 1;
    // True: frames leave at their capture times. False: each message leaves
    // as soon as the one before is answered.
    bool real_time = false;
  };
  struct Totals {
    uint64_t frames = 0;
    // Frames that were neither answered nor superseded by newer answers.
    uint64_t lost = 0;
    // Of each message, from sending it to the answer to its last frame.
    std::vector<double> rtt_us;
  };
  using OnTrial = std::function<void(const TrialResult&)>;

  // `driver` is unconfigured and outlives the robot.
  Robot(std::shared_ptr<grpc::Channel> channel, TrialDriver* driver,
        const Options& options, OnTrial on_trial);

  // Plays all trials. INVALID_CONFIG for a label the model does not know.
  absl::Status Run();

  const Totals& totals() const { return totals_; }
  // Once Run returned.
  const std::vector<std::string>& class_names() const { return class_names_; }

 private:
  absl::Status Play();
  absl::Status PlayFrame(const SkinFrame& frame);
  absl::Status SendBatch();
  absl::Status EndTrial();
  absl::StatusOr<TrialResult> Result(const v1::Posterior& posterior) const;
  void OnResponse(const v1::ClassifyContactResponse& response);
  // Waits until `condition` holds under mutex_, or the stream's end.
  absl::Status Await(const std::function<bool()>& condition);

  const std::shared_ptr<grpc::Channel> channel_;
  TrialDriver* const driver_;
  const Options options_;
  const OnTrial on_trial_;
  std::unique_ptr<ContactStream> stream_;
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
  std::optional<v1::Posterior> final_;
};

}  // namespace tactus::client

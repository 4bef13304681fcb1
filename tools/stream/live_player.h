// File: live_player.h
//
// LivePlayer: streams a real skin to a server until it is stopped, and reports
// each contact when it ends.
//
//   LivePlayer player(channel, &driver, {.seconds = 60},
//                     [](const LiveContact& contact) { Print(contact); },
//                     [](const std::string& news) { Print(news); });
//   TACTUS_RETURN_IF_ERROR(player.Run());
//
// Lost frames become jumps in the sequence numbers. If the skin sends nothing,
// the stream waits; an error of the driver ends it, after the server's last
// answers have been taken. If the connection to the server is lost, frames are
// kept until it stands again (resumable_stream.h); Stop does not wait for it.
// Run belongs to one thread; contacts and news are reported on it. Stop may be
// called from any thread and from a signal handler.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "client/drivers/calibrated_driver.h"
#include "client/drivers/labelled_driver.h"
#include "client/drivers/skin_driver.h"
#include "client/kinematics/skin_places.h"
#include "client/recording/answer_check.h"
#include "client/recording/recorder.h"
#include "client/stream/frame_encoder.h"
#include "client/stream/resumable_stream.h"
#include "grpcpp/channel.h"
#include "tools/common/measured_rate.h"
#include "tools/stream/live_observer.h"

namespace tactus::internal::client {

struct LiveContact {
  // Counts from 1.
  uint64_t id = 0;
  // On the driver's clock, and how long it lasted.
  int64_t onset_ns = 0;
  double duration_s = 0;
  // Index of the most probable class, and its probability.
  int answer = 0;
  double probability = 0;
  double unknown = 0;
  std::vector<double> log_likelihood;
  // The decision's class and time since onset, if one was reached.
  std::optional<int> decision;
  double decision_ms = 0;
  // Where it began, in the world, metres. With Options::pose_at, if the pose
  // was known.
  std::optional<Eigen::Vector3d> place = std::nullopt;
  // Frames of the stream that the server knows to be lost, until its end.
  uint64_t frames_missing = 0;
};

class LivePlayer {
 public:
  struct Options {
    std::string model = {};
    bool sparse = false;
    // 0: until Stop or the end of the driver's data.
    double seconds = 0;
    StreamTimeouts timeouts = {};
    // How long a lost stream may take to go on (resumable_stream.h); 0: a loss
    // is an error.
    std::chrono::milliseconds resume_for{0};
    std::string token = {};
    // Names the robot to the server, and to a proxy (robot_id.h).
    std::string client_id = {};
    // Milliseconds without a touch after which a contact ends; 0: the model's;
    // below 0: none ends.
    int release_after_ms = 0;
    // Contacts that are followed at the same time; 0: the server's default.
    int max_contacts = 0;
    // Sees all frames, and answers to each of them; may be null. Outlives the
    // player.
    LiveObserver* observer = nullptr;
    // If set, what the driver returns and what the server answers is recorded.
    Recorder* recorder = nullptr;
    // The driver, if it is a labelled one: it describes each recorded trial.
    const LabelledDriver* labelled = nullptr;
    // Describes the recorded trials of another driver.
    RecordingTexts trial = {};
    // The driver, if it is a calibrated one: what the skin sent is recorded
    // too.
    const CalibratedDriver* calibrated = nullptr;
    // If set, gets the server's answers.
    AnswerCheck* check = nullptr;
    // Which frames the server answers. If not set: all of them if there is an
    // observer, else those that change the answer.
    std::optional<v1::ResultCadence> cadence = {};
    // If set, contacts have their place: the pose of the skin's link at a
    // capture time. Thread-safe.
    std::function<std::optional<Pose>(int64_t capture_time_ns)> pose_at = {};
  };
  using OnContact = std::function<void(const LiveContact&)>;
  using OnNews = std::function<void(const std::string&)>;

  // `driver` is unconfigured and outlives the player. Run finalises it.
  LivePlayer(std::shared_ptr<grpc::Channel> channel, SkinDriver* driver,
             const Options& options, OnContact on_contact, OnNews on_news);

  absl::Status Run();
  void Stop() { stop_ = true; }

  // Valid after Run.
  uint64_t frames() const { return frames_; }
  uint64_t missing() const { return missing_; }
  const std::vector<std::string>& class_names() const { return class_names_; }
  const DriverStatistics& statistics() const { return statistics_; }

 private:
  absl::Status Stream();
  absl::Status Play();
  absl::Status SendFrame(const SkinFrame& frame);
  absl::Status EndTrial();
  void OnResponse(const v1::ClassifyContactResponse& response);
  // Keeps the place in the world of each contact that begins.
  void KeepPlaces(const v1::Answer& answer);
  LiveContact ContactOf(const v1::Contact& contact, const v1::Answer& answer,
                        int index);
  void ReportContacts();
  void ReportNews();
  void ReportConnection();
  // Compares the rate of the skin with the configured one, once it is known.
  void CheckRate(const SkinFrame& frame);
  // Reports a rate that is not the configured one, once.
  void ReportRate(double measured_hz);

  const std::shared_ptr<grpc::Channel> channel_;
  SkinDriver* const driver_;
  const Options options_;
  const OnContact on_contact_;
  const OnNews on_news_;
  std::atomic<bool> stop_ = false;
  std::unique_ptr<ResumableStream> stream_;
  std::optional<FrameEncoder> encoder_;
  std::vector<std::string> class_names_;
  // The recorder has the beginning of a trial, and not its end.
  bool in_trial_ = false;
  uint64_t frames_ = 0;
  double stated_hz_ = 0;
  // Rate of the first frames.
  MeasuredRate rate_;
  bool rate_reported_ = false;
  uint64_t missing_ = 0;
  DriverStatistics statistics_;
  // Reported so far.
  std::string last_problem_;
  std::string last_refused_;
  bool was_connected_ = true;
  bool had_poses_ = true;
  bool was_resuming_ = false;
  uint64_t without_beginning_ = 0;
  std::vector<int> stuck_;

  // Used by the stream's reading thread: where the contacts began, by id.
  std::optional<SkinPlaces> places_;
  std::map<uint64_t, Eigen::Vector3d> place_of_;

  // Shared with the stream's reading thread.
  std::mutex mutex_;
  std::deque<LiveContact> contacts_;
  // The rate that the server found by the frames' times, if it is another one.
  std::optional<double> noticed_hz_;
};

}  // namespace tactus::internal::client

// File: bridge.h
//
// Bridge: a skin's topic of ROS 2 to a stream, and the stream's answers to
// topics.
//
//   Bridge bridge(node.get(), {.topic = "/touch", .file = skin_file,
//                              .open = [&](const Skin& skin,
//                                          const StreamOptions& options) {
//                                return client.Open(skin, options);
//                              }},
//                 [](const std::string& news) { Print(news); });
//   TACTUS_RETURN_IF_ERROR(bridge.Run());
//
// It publishes NAME/contacts, NAME/events, NAME/markers and /diagnostics. A
// skin that falls silent ends the trial; its next frame begins another. A
// stream that is lost for good is opened again until that succeeds.
//
// Run belongs to one thread. Answers are published on the stream's thread, news
// are reported on both. Stop may be called from any thread and from a signal
// handler.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/ros2/dds_node.h"
#include "client/ros2/link_poses.h"
#include "client/ros2/skin_topic.h"
#include "client/ros2/touch_messages.h"
#include "core/import/skin_file.h"
#include "tactus/skin.h"
#include "tactus/stream.h"

namespace tactus::internal::client {

struct BridgeOptions {
  std::string topic = {};
  // Empty: as somebody publishes it.
  std::string type = {};
  // The text of its .msg file, for types that are not built in.
  std::string definition = {};
  DdsQos qos = SensorQos();
  SkinFile file = {};
  // Names the link that carries the skin.
  std::string frame_id = {};
  // Where the link is, and the topic of what it takes; null: frames have no
  // poses. Outlives the bridge.
  LinkPoses* poses = nullptr;
  std::string pose_topic = {};
  // Where the answers go.
  std::string name = "/tactus";
  StreamOptions stream = {};
  // Opens a stream.
  std::function<absl::StatusOr<std::unique_ptr<Stream>>(const Skin&,
                                                        const StreamOptions&)>
      open = {};
  // Without a frame for this long, the trial ends.
  std::chrono::milliseconds silence{1'000};
  // Between two attempts to open a stream.
  std::chrono::milliseconds pause{1'000};
  // Between two messages of /diagnostics.
  std::chrono::milliseconds diagnosis{1'000};
};

class Bridge {
 public:
  using OnNews = std::function<void(const std::string&)>;

  // `node` outlives the bridge.
  Bridge(DdsNode* node, BridgeOptions options, OnNews on_news);

  // Until Stop, or an error that another attempt does not change.
  absl::Status Run();
  void Stop() { stop_ = true; }

 private:
  using Clock = std::chrono::steady_clock;

  absl::Status Advertise();
  absl::Status WaitForType();
  absl::Status Loop();
  void TakePoses();
  // False if the frame has no pose.
  bool FindPose();
  void Refuse(const std::string& topic, const absl::Status& status);
  absl::Status TakeMessage(const DdsMessage& message);
  absl::Status PushFrame();
  absl::Status EndTrial();
  absl::Status OpenStream();
  // Returns the error if it will come again.
  absl::Status LoseStream(const absl::Status& status);
  absl::Status Watch();
  absl::Status Close();
  void Publish(const Answer& answer);
  void Write(DdsWriter& writer, const std::string& bytes);
  void Diagnose();
  void News(const std::string& news) { on_news_(news); }

  DdsNode* const node_;
  BridgeOptions options_;
  const OnNews on_news_;
  std::atomic<bool> stop_ = false;

  Skin skin_;
  std::optional<SkinTopic> skin_topic_;
  std::unique_ptr<DdsReader> reader_;
  std::unique_ptr<DdsReader> pose_reader_;
  std::unique_ptr<DdsWriter> contacts_;
  std::unique_ptr<DdsWriter> events_;
  std::unique_ptr<DdsWriter> markers_;
  std::unique_ptr<DdsWriter> diagnostics_;

  Frame frame_;
  std::optional<int64_t> last_time_ns_;
  bool in_trial_ = false;
  bool was_silent_ = false;
  bool was_resuming_ = false;
  std::string refused_policy_;
  Clock::time_point last_frame_ = Clock::now();
  Clock::time_point next_attempt_ = Clock::now();
  Clock::time_point next_diagnosis_ = Clock::now();
  // Why there is no stream, and why the last message was refused.
  std::string stream_problem_ = "is not open yet";
  std::string last_refusal_;
  // Why frames have no pose; empty while they have one.
  std::string pose_problem_;
  uint64_t frames_ = 0;
  uint64_t missing_ = 0;
  uint64_t refused_ = 0;
  uint64_t without_pose_ = 0;
  uint64_t not_sent_ = 0;
  uint64_t frames_diagnosed_ = 0;
  // Messages that a slow subscriber did not take in time.
  std::atomic<uint64_t> unwritten_ = 0;

  // The last, because its thread uses the others.
  std::unique_ptr<Stream> stream_;
};

}  // namespace tactus::internal::client

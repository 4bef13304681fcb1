// tactus-ros2: streams a skin that publishes on a topic of ROS 2 to a server,
// or classifies in this process, and publishes its contacts. It speaks DDS and
// needs no ROS.
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>

#include "CLI/CLI.hpp"
#include "absl/strings/str_cat.h"
#include "client/ros2/dds_node.h"
#include "client/ros2/link_poses.h"
#include "client/stream/robot_id.h"
#include "core/base/arguments.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/limits_bags.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/base/version.h"
#include "core/files/file_bytes.h"
#include "tactus/classifier.h"
#include "tactus/client.h"
#include "tools/common/token_file.h"
#include "tools/common/vetted_servers.h"
#include "tools/ros2/bridge.h"

namespace tactus::internal::client {
namespace {

struct Flags {
  std::string server = "127.0.0.1:50051";
  std::string tls_ca;
  std::string token_file;
  double reconnect_s = 30;
  // A model's file: no server is asked.
  std::string bundle;
  // The skin: a skin.json, or the name of a preset.
  std::string mapping;
  std::string skin = "cody-forearm";
  double scale = 1;
  double rate_hz = 100;
  std::string definition;
  // Where the skin is; without both, frames have no poses.
  std::string urdf;
  std::string skin_link;
  std::string joint_topic = "/joint_states";
  double pose_age_ms = 70;
  std::optional<int> domain;
  bool reliable = false;
  int depth = 5;
  double silence_s = 1;
  BridgeOptions bridge;
};

Bridge* running = nullptr;

void StopRunning(int) { running->Stop(); }

void PrintNews(const std::string& news) {
  std::fprintf(stderr, "tactus-ros2: %s\n", news.c_str());
}

absl::StatusOr<SkinFile> MakeSkin(const Flags& flags) {
  if (!flags.mapping.empty()) return ReadSkinFile(flags.mapping);
  SkinFile file;
  TACTUS_ASSIGN_OR_RETURN(file.layout, LayoutPreset(flags.skin));
  file.scale = flags.scale;
  file.sample_rate_hz = flags.rate_hz;
  return file;
}

// Null without poses.
absl::StatusOr<std::unique_ptr<LinkPoses>> MakePoses(const Flags& flags,
                                                     BridgeOptions& bridge) {
  const LinkPosesOptions options = {
      .max_age_ns = static_cast<int64_t>(flags.pose_age_ms * 1e6)};
  if (!flags.urdf.empty()) {
    bridge.pose_topic = flags.joint_topic;
    TACTUS_ASSIGN_OR_RETURN(const std::string urdf,
                            ReadFileBytes(flags.urdf, limits::kMaxUrdfBytes));
    auto poses = LinkPoses::FromJoints(urdf, flags.skin_link, options);
    return poses.ok() ? std::move(poses) : Annotate(poses.status(), flags.urdf);
  }
  if (bridge.pose_topic.empty()) bridge.pose_topic = bridge.file.pose_topic;
  if (bridge.pose_topic.empty()) return nullptr;
  return LinkPoses::FromPoses(options);
}

absl::Status Run(Flags& flags) {
  BridgeOptions& bridge = flags.bridge;
  TACTUS_ASSIGN_OR_RETURN(bridge.file, MakeSkin(flags));
  if (bridge.topic.empty()) bridge.topic = bridge.file.dataset;
  if (bridge.topic.empty()) {
    return InvalidConfig("--topic", "absent",
                         "the topic of the skin, or dataset in --mapping");
  }
  if (!bridge.stream.client_id.empty() && !IsRobotId(bridge.stream.client_id)) {
    return InvalidConfig("--client-id", Quoted(bridge.stream.client_id),
                         "printable ASCII without a space at its ends");
  }
  if (!flags.definition.empty()) {
    TACTUS_ASSIGN_OR_RETURN(
        bridge.definition,
        ReadFileBytes(flags.definition, limits::kMaxBagDefinitionBytes));
  }
  if (bridge.frame_id.empty()) bridge.frame_id = flags.skin_link;
  if (bridge.frame_id.empty()) bridge.frame_id = bridge.file.layout.name;
  bridge.qos = {.reliable = flags.reliable, .depth = flags.depth};
  bridge.silence =
      std::chrono::milliseconds(static_cast<int64_t>(flags.silence_s * 1'000));
  TACTUS_ASSIGN_OR_RETURN(const auto poses, MakePoses(flags, bridge));
  bridge.poses = poses.get();
  std::optional<Client> client;
  std::optional<Classifier> classifier;
  if (flags.bundle.empty()) {
    ClientOptions options = {.tls_ca = flags.tls_ca};
    // The bridge tries again by itself, and ends sooner.
    options.open_timeout = std::chrono::milliseconds(3'000);
    options.resume_for = std::chrono::milliseconds(
        static_cast<int64_t>(flags.reconnect_s * 1'000));
    if (!flags.token_file.empty()) {
      TACTUS_ASSIGN_OR_RETURN(
          options.token,
          ReadToken(flags.token_file, flags.server, !flags.tls_ca.empty()));
    }
    client.emplace(flags.server, options);
  } else {
    TACTUS_ASSIGN_OR_RETURN(classifier, Classifier::Load(flags.bundle));
  }
  bridge.open = [&](const Skin& skin, const StreamOptions& options) {
    return client ? client->Open(skin, options)
                  : classifier->Open(skin, options);
  };
  TACTUS_ASSIGN_OR_RETURN(const auto node,
                          DdsNode::Open({.domain = flags.domain}));
  Bridge running_bridge(node.get(), bridge, PrintNews);
  running = &running_bridge;
  std::signal(SIGINT, StopRunning);
  std::signal(SIGTERM, StopRunning);
  const absl::Status status = running_bridge.Run();
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  return status;
}

int Main(int argc, char** argv) {
  VetServers("tactus-ros2");
  if (const absl::Status status = CheckArguments(argc, argv); !status.ok()) {
    std::fprintf(stderr, "tactus-ros2: %s\n",
                 std::string(status.message()).c_str());
    return 2;
  }
  Flags flags;
  CLI::App app(
      "Streams a skin's topic of ROS 2 to a Tactus server and publishes its "
      "contacts.",
      "tactus-ros2");
  app.set_version_flag("--version", std::string("tactus-ros2 ") + kVersion);
  app.add_option("--server", flags.server, "host:port or unix:path")
      ->capture_default_str();
  app.add_option("--tls-ca", flags.tls_ca,
                 "PEM file of the authorities that may vouch for the server; "
                 "with it, the connection uses TLS")
      ->check(CLI::ExistingFile);
  app.add_option("--token-file", flags.token_file,
                 "File with the token that the server knows the robot by")
      ->check(CLI::ExistingFile);
  app.add_option("--client-id", flags.bridge.stream.client_id,
                 "Name of the robot, for the server's log: printable ASCII");
  app.add_option("--model", flags.bridge.stream.model,
                 "Model of the server; absent: the one that fits the skin");
  app.add_option("--reconnect-s", flags.reconnect_s,
                 "Seconds for which frames of a lost stream are kept")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  auto* const bundle =
      app.add_option("--bundle", flags.bundle,
                     "A model's file (trainctl fit): this process classifies, "
                     "and no server is asked")
          ->check(CLI::ExistingFile);
  for (const char* const name :
       {"--server", "--tls-ca", "--token-file", "--model", "--reconnect-s"}) {
    bundle->excludes(app.get_option(name));
  }
  app.add_option("--topic", flags.bridge.topic,
                 "Topic of the skin, e.g. /touch; absent: dataset in "
                 "--mapping");
  app.add_option("--type", flags.bridge.type,
                 "Its type, e.g. std_msgs/msg/UInt16MultiArray; absent: as it "
                 "is published");
  app.add_option("--definition", flags.definition,
                 "File with the definition of a type that is not built in: the "
                 "text of its .msg file, then of those it uses, each after a "
                 "line of = and a line MSG: package/Type")
      ->check(CLI::ExistingFile);
  auto* const mapping =
      app.add_option("--mapping", flags.mapping,
                     "skin.json that says what the numbers of a message are, "
                     "as trainctl import takes it")
          ->check(CLI::ExistingFile);
  app.add_option("--skin", flags.skin,
                 "Without --mapping: cody-forearm, vitac-12x32 or icub-6x10")
      ->capture_default_str()
      ->excludes(mapping);
  app.add_option("--scale", flags.scale,
                 "Without --mapping: numbers times this are the skin's unit")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->excludes(mapping);
  app.add_option("--rate-hz", flags.rate_hz,
                 "Without --mapping: frames per second")
      ->check(CLI::PositiveNumber)
      ->capture_default_str()
      ->excludes(mapping);
  app.add_option("--frame-id", flags.bridge.frame_id,
                 "Link that carries the skin, for tf; absent: --skin-link, or "
                 "the skin's name");
  auto* const urdf =
      app.add_option("--urdf", flags.urdf,
                     "URDF of the robot: the skin's pose follows from joint "
                     "values")
          ->check(CLI::ExistingFile);
  auto* const link = app.add_option("--skin-link", flags.skin_link,
                                    "Link in --urdf that carries the skin");
  urdf->needs(link);
  link->needs(urdf);
  app.add_option("--joint-topic", flags.joint_topic,
                 "Topic of sensor_msgs/JointState")
      ->capture_default_str()
      ->needs(urdf);
  app.add_option("--pose-topic", flags.bridge.pose_topic,
                 "Topic of geometry_msgs/PoseStamped with the pose of the "
                 "skin's link; absent: pose_topic in --mapping, or none")
      ->excludes(urdf);
  app.add_option("--pose-age-ms", flags.pose_age_ms,
                 "Frames are lost if poses are older")
      ->check(CLI::Range(1.0, 10'000.0))
      ->capture_default_str();
  app.add_option("--name", flags.bridge.name,
                 "Publish NAME/contacts, NAME/events and NAME/markers")
      ->capture_default_str();
  app.add_option("--domain", flags.domain,
                 "DDS domain; absent: ROS_DOMAIN_ID, or 0")
      ->check(CLI::Range(0, 232));
  app.add_flag("--reliable", flags.reliable,
               "Ask for lost frames again; the publisher must be reliable");
  app.add_option("--depth", flags.depth, "Frames that are kept until taken")
      ->check(CLI::Range(1, 100'000))
      ->capture_default_str();
  app.add_option("--silence-s", flags.silence_s,
                 "Without a frame for this long, contacts end")
      ->check(CLI::Range(0.05, 3600.0))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  const absl::Status status = Run(flags);
  if (status.ok()) return 0;
  std::fprintf(stderr, "tactus-ros2: %s\n",
               std::string(status.message()).c_str());
  return 1;
}

}  // namespace
}  // namespace tactus::internal::client

int main(int argc, char** argv) {
  return tactus::internal::client::Main(argc, argv);
}

// tactus-ros2 with a robot of another implementation of DDS (fastdds_peer.cc):
// the answers that arrive there are those of the library for the same frames,
// bit for bit.
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <functional>
#include <map>
#include <random>
#include <sstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "client/kinematics/arm_model.h"
#include "core/skin/layout.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tactus/classifier.h"
#include "tactus/client.h"
#include "tests/client/stream/restarted_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/time_limit.h"
#include "tools/ros2/bridge.h"

namespace tactus::internal::client {
namespace {

using std::chrono::milliseconds;
using testing::ChildTactusd;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::RestartedServer;

constexpr int kRows = 16;
constexpr int kColumns = 24;
constexpr size_t kTaxels = kRows * kColumns;
// Times in the peer's images.
constexpr int64_t kFirstNs = 1'700'000'000'000'000'000;
constexpr int64_t kPeriodNs = 10'000'000;

// Only this host, and without multicast. Tests that run at the same time have
// other domains or at least other topics. `place`: below 20.
int TestDomain(int place) {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
         "name=\"lo\" multicast=\"false\"/></Interfaces><AllowMulticast>false"
         "</AllowMulticast></General><Discovery><Peers><Peer "
         "address=\"127.0.0.1\"/></Peers><ParticipantIndex>auto"
         "</ParticipantIndex></Discovery></Domain></CycloneDDS>",
         1);
  return 1 + (getpid() * 20 + place) % 200;
}

std::string Unique(const std::string& name) {
  static int count = 0;
  return absl::StrCat(name, "_", getpid(), "_", ++count);
}

// Presses here and there, as whole numbers up to 250.
std::vector<double> MakeFrames(size_t count) {
  constexpr unsigned kSeed = 5;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  std::vector<double> frames(count * kTaxels, 0);
  size_t row = 0;
  size_t column = 0;
  for (size_t t = 0; t < count; ++t) {
    const size_t at = t % 80;
    if (at == 0) {
      row = random() % (kRows - 1);
      column = random() % (kColumns - 1);
    }
    if (at < 10 || at >= 60) continue;
    for (const size_t taxel :
         {row * kColumns + column, row * kColumns + column + 1,
          (row + 1) * kColumns + column}) {
      frames[t * kTaxels + taxel] =
          static_cast<double>((at - 10) * 5 + random() % 3);
    }
  }
  return frames;
}

// As fastdds_peer.cc writes contacts.
std::string ContactText(const Contact& contact) {
  const ContactPatch patch = contact.patch.value_or(ContactPatch{});
  std::string text = absl::StrFormat(
      " [%d %d %a %a %a", contact.id, static_cast<int>(contact.state),
      patch.force, patch.centroid.link.x, contact.unknown);
  for (const NamedProbability& named : contact.classes) {
    absl::StrAppendFormat(&text, " %s=%a", named.name, named.probability);
  }
  for (const QuestionAnswer& question : contact.answers) {
    absl::StrAppend(&text, " ", question.question, ":",
                    question.decided ? question.decided->value : "");
    for (const NamedProbability& named : question.values) {
      absl::StrAppendFormat(&text, " %a", named.probability);
    }
  }
  if (contact.object) {
    absl::StrAppendFormat(&text, " object %a %a",
                          contact.object->log10_stiffness,
                          contact.object->moved_deviation_m);
  }
  if (patch.centroid.world) {
    absl::StrAppendFormat(&text, " at %a", patch.centroid.world->x);
  }
  return text + "]";
}

// A line of the peer about contacts.
struct HeardContacts {
  uint64_t frame = 0;
  int64_t stamp_ns = 0;
  int64_t arrived_ns = 0;
  bool is_final = false;
  uint64_t missing = 0;
  std::string contacts;
};

struct Heard {
  std::vector<HeardContacts> contacts;
  std::vector<std::string> events;
  std::vector<std::string> markers;
  std::vector<std::string> diagnostics;
  std::map<int, int64_t> sent_ns;
};

// The peer as a process.
class Peer {
 public:
  Peer(const ScratchDir& folder, int domain, const std::string& topic,
       const std::map<std::string, std::string>& settings)
      : heard_(folder / Unique("heard")) {
    std::vector<std::string> words = {FASTDDS_PEER,
                                      absl::StrCat("domain=", domain),
                                      "topic=" + topic,
                                      "name=" + topic + "/tactus",
                                      absl::StrCat("rows=", kRows),
                                      absl::StrCat("columns=", kColumns),
                                      "heard=" + heard_};
    for (const auto& [key, value] : settings) {
      words.push_back(absl::StrCat(key, "=", value));
    }
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn(&pid_, FASTDDS_PEER, nullptr, nullptr, pointers.data(),
                environ);
  }
  Peer(const Peer&) = delete;
  Peer& operator=(const Peer&) = delete;

  Heard Wait() const {
    int status = 0;
    waitpid(pid_, &status, 0);
    EXPECT_EQ(status, 0);
    return Read();
  }
  // So far.
  Heard Read() const {
    Heard heard;
    std::ifstream in(heard_);
    for (std::string line; std::getline(in, line);) {
      std::istringstream words(line);
      std::string what;
      words >> what;
      const std::string rest =
          line.substr(std::min(what.size() + 1, line.size()));
      if (what == "event") heard.events.push_back(rest);
      if (what == "markers") heard.markers.push_back(rest);
      if (what == "diagnostics") heard.diagnostics.push_back(rest);
      if (what == "sent") {
        int number = 0;
        words >> number;
        words >> heard.sent_ns[number];
      }
      if (what == "contacts") {
        HeardContacts each;
        words >> each.frame >> each.stamp_ns >> each.arrived_ns >>
            each.is_final >> each.missing;
        std::getline(words, each.contacts);
        heard.contacts.push_back(each);
      }
    }
    return heard;
  }

 private:
  const std::string heard_;
  pid_t pid_ = 0;
};

SkinFile ForearmFile() {
  SkinFile file;
  file.layout = *LayoutPreset("cody-forearm");
  file.scale = 0.01;
  file.sample_rate_hz = 100;
  return file;
}

// A bridge on a thread.
class RunningBridge {
 public:
  RunningBridge(int domain, BridgeOptions options) {
    auto node = DdsNode::Open({.domain = domain});
    EXPECT_TRUE(node.ok()) << node.status();
    node_ = *std::move(node);
    options.diagnosis = milliseconds(100);
    bridge_.emplace(node_.get(), std::move(options),
                    [this](const std::string& news) {
                      const std::lock_guard lock(mutex_);
                      news_.push_back(news);
                    });
    thread_ = std::thread([this] { status_ = bridge_->Run(); });
  }
  ~RunningBridge() {
    if (!thread_.joinable()) return;
    const absl::Status status = Stop();
    EXPECT_TRUE(status.ok()) << status;
  }
  absl::Status Stop() {
    bridge_->Stop();
    thread_.join();
    return status_;
  }
  std::vector<std::string> news() {
    const std::lock_guard lock(mutex_);
    return news_;
  }

 private:
  std::unique_ptr<DdsNode> node_;
  std::optional<Bridge> bridge_;
  std::mutex mutex_;
  std::vector<std::string> news_;
  absl::Status status_;
  std::thread thread_;
};

BridgeOptions Options(const std::string& topic) {
  BridgeOptions options;
  options.topic = topic;
  options.name = topic + "/tactus";
  options.file = ForearmFile();
  options.frame_id = "forearm";
  return options;
}

// Writes each answer but the last into `by`, by frame.
StreamOptions Into(std::map<uint64_t, std::string>& by) {
  StreamOptions options;
  options.on_answer = [&by](const Answer& answer) {
    if (answer.is_final) return;
    std::string& text = by[answer.sequence];
    for (const Contact& contact : answer.contacts) {
      text += ContactText(contact);
    }
  };
  return options;
}

Frame FrameOf(const std::vector<double>& numbers, size_t index) {
  Frame frame;
  for (size_t i = 0; i < kTaxels; ++i) {
    frame.values.push_back(
        static_cast<float>(0.01 * numbers[index * kTaxels + i]));
  }
  return frame;
}

Skin Forearm(bool with_poses) {
  const auto skin = SkinOf(ForearmFile(), with_poses);
  EXPECT_TRUE(skin.ok()) << skin.status();
  return *skin;
}

template <typename Number>
void Write(const std::string& path, const std::vector<double>& all) {
  const std::vector<Number> numbers(all.begin(), all.end());
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(numbers.data()),
             static_cast<std::streamsize>(all.size() * sizeof(Number)));
}

void WriteAs(const std::string& type, const std::string& path,
             const std::vector<double>& all) {
  if (type == "u16" || type == "mono16") Write<uint16_t>(path, all);
  if (type == "i16") Write<int16_t>(path, all);
  if (type == "mono8") Write<uint8_t>(path, all);
  if (type == "f32" || type == "32FC1") Write<float>(path, all);
}

// The frame that was published at this time: DDS rounds times.
int IndexOf(const Heard& heard, int64_t stamp_ns, bool image) {
  if (image) return static_cast<int>((stamp_ns - kFirstNs) / kPeriodNs);
  for (const auto& [index, sent_ns] : heard.sent_ns) {
    if (std::abs(sent_ns - stamp_ns) <= 2) return index;
  }
  ADD_FAILURE() << "no frame was published at " << stamp_ns;
  return 0;
}

struct Checked {
  size_t frames = 0;
  size_t touching = 0;
};

// Compares what was heard with what `stream` answers to the same frames. Those
// that were lost on the way to tactus-ros2 are lost here too.
Checked ExpectTheAnswersOf(Stream& stream,
                           std::map<uint64_t, std::string>& want,
                           const Heard& heard,
                           const std::vector<double>& numbers, bool image,
                           const std::function<LinkPose(int)>& pose = {}) {
  Checked checked;
  std::vector<HeardContacts> answers;
  uint64_t last = 0;
  for (const HeardContacts& each : heard.contacts) {
    if (each.is_final) continue;
    EXPECT_TRUE(last == 0 || each.frame > last);
    const int index = IndexOf(heard, each.stamp_ns, image);
    Frame frame = FrameOf(numbers, index);
    frame.capture_time_ns = each.stamp_ns;
    // All frames that came were answered; so these did not come, or came late
    // because the publisher was late.
    if (last > 0) frame.missing_before = each.frame - last - 1;
    if (pose) frame.pose = pose(index);
    const absl::Status pushed = stream.Push(frame);
    EXPECT_TRUE(pushed.ok()) << pushed;
    last = each.frame;
    answers.push_back(each);
  }
  EXPECT_TRUE(stream.Close().ok());
  const uint64_t first = answers.empty() ? 0 : answers.front().frame;
  for (const HeardContacts& each : answers) {
    // The library counts from its own first frame.
    const uint64_t frame = each.frame - first + want.begin()->first;
    EXPECT_EQ(each.contacts, want[frame]) << each.frame;
    ++checked.frames;
    checked.touching += !each.contacts.empty();
  }
  return checked;
}

void PrintDelays(const Heard& heard) {
  std::vector<double> ms;
  for (const HeardContacts& each : heard.contacts) {
    if (each.is_final) continue;
    ms.push_back(static_cast<double>(each.arrived_ns - each.stamp_ns) / 1e6);
  }
  std::ranges::sort(ms);
  std::printf(
      "from publishing a frame to hearing its contacts: median %.2f "
      "ms, 99 of 100 within %.2f ms\n",
      ms[ms.size() / 2], ms[ms.size() * 99 / 100]);
}

// A robot that streams whole numbers to a server, reliably, so that nothing is
// lost on a machine that is busy.
class ServerTest : public ::testing::Test {
 protected:
  BridgeOptions ToServer() {
    BridgeOptions options = Options(topic_);
    options.qos = {.reliable = true, .depth = 2'000};
    options.open = [this](const Skin& skin, const StreamOptions& stream) {
      return client_.Open(skin, stream);
    };
    return options;
  }
  std::map<std::string, std::string> Publishing(int count, double linger_s) {
    WriteAs("u16", folder_ / "frames", numbers_);
    return {{"type", "u16"},
            {"reliable", "1"},
            {"rate", "100"},
            {"count", absl::StrCat(count)},
            {"linger", absl::StrCat(linger_s)},
            {"frames", folder_ / "frames"}};
  }
  void ExpectTheServersAnswers(const Heard& heard, int count) {
    ASSERT_EQ(heard.sent_ns.size(), static_cast<size_t>(count));
    std::map<uint64_t, std::string> want;
    // In this process: a server may supersede an answer that is read late.
    const auto classifier = Classifier::Load(NO_POSES);
    ASSERT_TRUE(classifier.ok()) << classifier.status();
    auto stream = classifier->Open(Forearm(false), Into(want));
    ASSERT_TRUE(stream.ok()) << stream.status();
    const Checked checked =
        ExpectTheAnswersOf(**stream, want, heard, numbers_, /*image=*/false);
    std::printf("%zu of %d frames answered\n", checked.frames, count);
    EXPECT_EQ(checked.frames, static_cast<size_t>(count));
    EXPECT_GT(checked.touching, 20u);
    EXPECT_GE(heard.events.size(), 3u);
  }

  const int domain_ = TestDomain(0);
  const std::string topic_ = Unique("/touch");
  const ScratchDir folder_;
  const std::vector<double> numbers_ = MakeFrames(1'000);
  RestartedServer server_;
  Client client_{server_.address()};
};

TEST_F(ServerTest, APublisherThatComesBackBeginsAnotherTrial) {
  RunningBridge bridge(domain_, ToServer());
  const Heard heard =
      Peer(folder_, domain_, topic_, Publishing(150, 1.5)).Wait();
  ExpectTheServersAnswers(heard, 150);
  EXPECT_THAT(heard.markers, Contains(HasSubstr("2 forearm ")));
  EXPECT_THAT(heard.diagnostics, Contains(HasSubstr("0 tactus-ros2: " + topic_ +
                                                    "; frames are answered")));
  // It fell silent.
  EXPECT_TRUE(heard.contacts.back().is_final);
  EXPECT_THAT(heard.diagnostics, Contains(HasSubstr("no frames come")));
  PrintDelays(heard);
  const Heard again =
      Peer(folder_, domain_, topic_, Publishing(40, 0.2)).Wait();
  EXPECT_THAT(bridge.news(), Contains(HasSubstr(topic_ + " sends again")));
  ASSERT_FALSE(again.contacts.empty());
  EXPECT_GT(again.contacts.front().frame, heard.contacts.back().frame);
  // The silence is no loss of frames; a busy machine may add a few.
  EXPECT_LT(again.contacts.back().missing, 100u);
}

TEST_F(ServerTest, AServerThatIsKilledChangesNothing) {
  RunningBridge bridge(domain_, ToServer());
  Peer peer(folder_, domain_, topic_, Publishing(200, 0.5));
  while (peer.Read().contacts.size() < 60) {
    std::this_thread::sleep_for(milliseconds(20));
  }
  server_.Restart();
  ExpectTheServersAnswers(peer.Wait(), 200);
  EXPECT_THAT(bridge.news(), Contains(HasSubstr("the stream goes on")));
}

// TACTUS_ROS2_FRAMES=1000 build/release/tests/ros2_peer_test
//   --gtest_filter=*Delays
TEST_F(ServerTest, Delays) {
  const char* const frames = std::getenv("TACTUS_ROS2_FRAMES");
  if (frames == nullptr) GTEST_SKIP() << "needs TACTUS_ROS2_FRAMES";
  const int count = std::min(std::atoi(frames), 1'000);
  RunningBridge bridge(domain_, ToServer());
  const Heard heard =
      Peer(folder_, domain_, topic_, Publishing(count, 0.3)).Wait();
  ExpectTheServersAnswers(heard, count);
  PrintDelays(heard);
}

// This process classifies; publishers and subscriber give their best effort.
struct InProcess {
  InProcess(const ScratchDir& folder, int place, const std::string& type,
            const std::string& model)
      : folder(folder),
        domain(TestDomain(place)),
        topic(Unique("/touch")),
        is_image(type == "mono8" || type == "mono16" || type == "32FC1"),
        classifier(*Classifier::Load(model)) {
    WriteAs(type, folder / "frames" + topic.substr(1), numbers);
    settings = {
        {"type", type},    {"reliable", "0"},
        {"rate", "100"},   {"count", "80"},
        {"linger", "0.3"}, {"frames", folder / "frames" + topic.substr(1)}};
    options = Options(topic);
    options.open = [this](const Skin& skin, const StreamOptions& stream) {
      return classifier.Open(skin, stream);
    };
  }

  void Start() {
    bridge = std::make_unique<RunningBridge>(domain, options);
    peer = std::make_unique<Peer>(folder, domain, topic, settings);
  }

  const ScratchDir& folder;
  const int domain;
  const std::string topic;
  const bool is_image;
  const std::vector<double> numbers = MakeFrames(80);
  Classifier classifier;
  std::map<std::string, std::string> settings;
  BridgeOptions options;
  std::unique_ptr<RunningBridge> bridge;
  std::unique_ptr<Peer> peer;
};

TEST(InProcessTest, AllTypesAreAnsweredAsByTheLibrary) {
  const ScratchDir folder;
  std::vector<std::unique_ptr<InProcess>> all;
  for (const char* const type : {"i16", "f32", "mono8", "mono16", "32FC1"}) {
    all.push_back(std::make_unique<InProcess>(
        folder, static_cast<int>(all.size()) + 1, type, NO_POSES));
    all.back()->Start();
  }
  for (const auto& each : all) {
    const std::string type = each->settings.at("type");
    SCOPED_TRACE(type);
    const Heard heard = each->peer->Wait();
    std::map<uint64_t, std::string> want;
    auto stream = each->classifier.Open(Forearm(false), Into(want));
    ASSERT_TRUE(stream.ok()) << stream.status();
    const Checked checked = ExpectTheAnswersOf(**stream, want, heard,
                                               each->numbers, each->is_image);
    std::printf("%s: %zu of 80 frames answered\n", type.c_str(),
                checked.frames);
    EXPECT_GT(checked.touching, 10u);
  }
}

constexpr char kArm[] = R"(
<robot name="arm">
  <link name="base"/>
  <link name="skin"/>
  <joint name="elbow" type="revolute">
    <parent link="base"/><child link="skin"/>
    <origin xyz="0.1 0 0.5"/><axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="1" velocity="1"/>
  </joint>
</robot>)";

TEST(InProcessTest, JointStatesGiveTheFramesTheirPoses) {
  auto arm = ArmModel::FromUrdf(kArm, "skin");
  if (!arm.ok()) GTEST_SKIP() << arm.status();
  const ScratchDir folder;
  InProcess robot(folder, 6, "mono16", WITH_POSES);
  const auto poses = LinkPoses::FromJoints(kArm, "skin", {});
  ASSERT_TRUE(poses.ok()) << poses.status();
  robot.options.poses = poses->get();
  robot.options.pose_topic = robot.topic + "/joint_states";
  robot.settings["joints"] = robot.options.pose_topic;
  robot.Start();
  const Heard heard = robot.peer->Wait();
  std::map<uint64_t, std::string> want;
  auto stream = robot.classifier.Open(Forearm(true), Into(want));
  ASSERT_TRUE(stream.ok()) << stream.status();
  const Checked checked = ExpectTheAnswersOf(
      **stream, want, heard, robot.numbers, /*image=*/true, [&](int index) {
        const std::vector<double> values = {index / 1000.0};
        const Pose pose = *arm->PoseOf(values);
        return LinkPose{pose.position.x(),    pose.position.y(),
                        pose.position.z(),    pose.orientation.x(),
                        pose.orientation.y(), pose.orientation.z(),
                        pose.orientation.w()};
      });
  EXPECT_GT(checked.touching, 10u);
  EXPECT_THAT(heard.contacts[30].contacts, HasSubstr(" at "));
}

// The program as a whole.
int RunAndSignal(const std::vector<std::string>& flags, int signal) {
  std::vector<std::string> words = {TACTUS_ROS2,
                                    absl::StrCat("--domain=", TestDomain(7))};
  words.insert(words.end(), flags.begin(), flags.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  pid_t pid = 0;
  posix_spawn(&pid, TACTUS_ROS2, nullptr, nullptr, pointers.data(), environ);
  if (signal != 0) {
    // Until it handles signals.
    std::this_thread::sleep_for(milliseconds(700));
    kill(pid, signal);
  }
  const testing::TimeLimit limit("tactus-ros2 ends",
                                 [pid] { kill(pid, SIGKILL); });
  int status = 0;
  waitpid(pid, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

TEST(ProgramTest, ItEndsWhenAsked) {
  // Nobody publishes, and no server is there.
  EXPECT_EQ(RunAndSignal({"--topic=/nobody", "--server=127.0.0.1:1"}, SIGTERM),
            0);
  EXPECT_EQ(
      RunAndSignal({"--topic=/nobody", std::string("--bundle=") + NO_POSES},
                   SIGINT),
      0);
}

TEST(ProgramTest, ItEndsAtMistakesThatStay) {
  const std::string bundle = std::string("--bundle=") + NO_POSES;
  EXPECT_EQ(RunAndSignal({bundle}, 0), 1);
  EXPECT_EQ(RunAndSignal({"--topic=no slash", bundle}, 0), 1);
  EXPECT_EQ(RunAndSignal({"--topic=/nobody", "--skin=vitac-12x32", bundle}, 0),
            1);
}

}  // namespace
}  // namespace tactus::internal::client

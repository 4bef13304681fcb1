// tactus-ros2 with a robot of another implementation of DDS (fastdds_peer.cc):
// the answers that arrive there are those of the library for the same frames,
// bit for bit.
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <thread>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_split.h"
#include "core/skin/layout.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tactus/classifier.h"
#include "tactus/client.h"
#include "tests/client/stream/restarted_server.h"
#include "tests/support/scratch_dir.h"
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
// other domains or at least other topics.
int TestDomain() {
  setenv("CYCLONEDDS_URI",
         "<CycloneDDS><Domain><General><Interfaces><NetworkInterface "
         "name=\"lo\" multicast=\"false\"/></Interfaces><AllowMulticast>false"
         "</AllowMulticast></General><Discovery><Peers><Peer "
         "address=\"127.0.0.1\"/></Peers><ParticipantIndex>auto"
         "</ParticipantIndex></Discovery></Domain></CycloneDDS>",
         1);
  return 1 + getpid() % 200;
}

std::string Unique(const std::string& name) {
  static int count = 0;
  return absl::StrCat(name, "_", getpid(), "_", ++count);
}

// Presses here and there, in millinewtons.
std::vector<uint16_t> MakeFrames(size_t count) {
  constexpr unsigned kSeed = 5;
  std::printf("seed %u\n", kSeed);
  std::mt19937 random(kSeed);
  std::vector<uint16_t> frames(count * kTaxels, 0);
  size_t row = 0;
  size_t column = 0;
  for (size_t t = 0; t < count; ++t) {
    const size_t at = t % 100;
    if (at == 0) {
      row = random() % (kRows - 1);
      column = random() % (kColumns - 1);
    }
    if (at < 10 || at >= 80) continue;
    for (const size_t taxel :
         {row * kColumns + column, row * kColumns + column + 1,
          (row + 1) * kColumns + column}) {
      frames[t * kTaxels + taxel] =
          static_cast<uint16_t>((at - 10) * 30 + random() % 5);
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
  Peer(const ScratchDir& folder, const std::string& topic,
       const std::map<std::string, std::string>& settings)
      : heard_(folder / Unique("heard")) {
    std::vector<std::string> words = {FASTDDS_PEER,
                                      absl::StrCat("domain=", TestDomain()),
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
  file.scale = 0.001;
  file.sample_rate_hz = 100;
  return file;
}

// A bridge on a thread.
class RunningBridge {
 public:
  explicit RunningBridge(BridgeOptions options) {
    auto node = DdsNode::Open({.domain = TestDomain()});
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

// What the library answers to `frames`, by frame.
std::map<uint64_t, std::string> Reference(Stream& stream,
                                          std::map<uint64_t, std::string>& by,
                                          const std::vector<Frame>& frames) {
  for (const Frame& frame : frames) {
    const absl::Status pushed = stream.Push(frame);
    EXPECT_TRUE(pushed.ok()) << pushed;
  }
  EXPECT_TRUE(stream.Close().ok());
  return by;
}

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

Frame FrameOf(const std::vector<uint16_t>& numbers, size_t index) {
  Frame frame;
  for (size_t i = 0; i < kTaxels; ++i) {
    frame.values.push_back(
        static_cast<float>(0.001 * numbers[index * kTaxels + i]));
  }
  return frame;
}

Skin Forearm() {
  const auto skin = SkinOf(ForearmFile(), false);
  EXPECT_TRUE(skin.ok()) << skin.status();
  return *skin;
}

void WriteNumbers(const std::string& path, const std::vector<uint16_t>& all) {
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(all.data()),
             static_cast<std::streamsize>(all.size() * sizeof(uint16_t)));
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

// Reliable, through a server, which is killed on the way.
void StreamArrays(int count, bool restart) {
  const ScratchDir folder;
  const std::string topic = Unique("/touch");
  const std::vector<uint16_t> numbers = MakeFrames(count);
  WriteNumbers(folder / "frames", numbers);
  RestartedServer server;
  Client client(server.address());
  BridgeOptions options = Options(topic);
  // Nothing is lost on a machine that is busy.
  options.qos = {.reliable = true, .depth = 2'000};
  options.open = [&](const Skin& skin, const StreamOptions& stream) {
    return client.Open(skin, stream);
  };
  RunningBridge bridge(options);
  Peer peer(folder, topic,
            {{"type", "u16"},
             {"reliable", "1"},
             {"rate", "100"},
             {"count", absl::StrCat(count)},
             {"linger", "1.6"},
             {"frames", folder / "frames"}});
  if (restart) {
    while (peer.Read().contacts.size() < 60) {
      std::this_thread::sleep_for(milliseconds(20));
    }
    server.Restart();
  }
  const Heard heard = peer.Wait();
  ASSERT_EQ(heard.sent_ns.size(), static_cast<size_t>(count));
  std::map<uint64_t, HeardContacts> by_frame;
  for (const HeardContacts& each : heard.contacts) {
    EXPECT_EQ(each.missing, 0u);
    if (!each.is_final) by_frame[each.frame] = each;
  }
  ASSERT_FALSE(by_frame.empty());
  const uint64_t first = by_frame.begin()->first;
  std::map<uint64_t, std::string> want;
  std::vector<Frame> frames;
  for (int i = 0; i < count; ++i) {
    frames.push_back(FrameOf(numbers, i));
    const auto found = by_frame.find(first + i);
    // DDS rounds times.
    frames.back().capture_time_ns =
        found == by_frame.end() ? heard.sent_ns.at(i) : found->second.stamp_ns;
    EXPECT_NEAR(static_cast<double>(frames.back().capture_time_ns -
                                    heard.sent_ns.at(i)),
                0, 2);
  }
  Client other(server.address());
  auto stream = other.Open(Forearm(), Into(want));
  ASSERT_TRUE(stream.ok()) << stream.status();
  Reference(**stream, want, frames);
  ASSERT_EQ(want.begin()->first, first);
  size_t touching = 0;
  for (const auto& [frame, each] : by_frame) {
    EXPECT_EQ(each.contacts, want[frame]) << frame;
    touching += !each.contacts.empty();
  }
  EXPECT_GT(touching, 50u);
  EXPECT_GT(heard.events.size(), 3u);
  EXPECT_THAT(heard.markers, Contains(HasSubstr("2 forearm ")));
  EXPECT_THAT(heard.diagnostics, Contains(HasSubstr("0 tactus-ros2: " + topic +
                                                    "; frames are answered")));
  // It fell silent.
  EXPECT_TRUE(heard.contacts.back().is_final);
  EXPECT_THAT(heard.diagnostics, Contains(HasSubstr("no frames come")));
  if (restart) {
    EXPECT_THAT(bridge.news(), Contains(HasSubstr("the stream goes on")));
  }
  std::printf("%zu of %d frames heard\n", by_frame.size(), count);
  if (!restart) PrintDelays(heard);
}

TEST(Ros2PeerTest, ArraysAreAnsweredByAServer) {
  StreamArrays(200, /*restart=*/false);
}

TEST(Ros2PeerTest, AServerThatIsKilledChangesNothing) {
  StreamArrays(250, /*restart=*/true);
}

// With ctest -R ros2_peer -V after exporting TACTUS_ROS2_FRAMES=1000.
TEST(Ros2PeerTest, Delays) {
  const char* const frames = std::getenv("TACTUS_ROS2_FRAMES");
  if (frames == nullptr) GTEST_SKIP() << "needs TACTUS_ROS2_FRAMES";
  StreamArrays(std::atoi(frames), /*restart=*/false);
}

}  // namespace
}  // namespace tactus::internal::client

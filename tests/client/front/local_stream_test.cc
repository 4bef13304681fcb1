// Classifier: its answers are those of a server, bit for bit.
#include "client/front/local_stream.h"

#include <cstdlib>
#include <fstream>
#include <limits>
#include <map>

#include "absl/strings/str_cat.h"
#include "client/drivers/sim_driver.h"
#include "client/front/wrapped_driver.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tactus/classifier.h"
#include "tactus/client.h"
#include "tests/client/front/front_frames.h"
#include "tests/client/stream/restarted_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_model.h"

namespace tactus::internal::client {
namespace {

using testing::AllOf;
using testing::CodyFrame;
using testing::CodySkin;
using ::testing::HasSubstr;
using testing::PollAll;
using testing::Record;
using testing::Touch;
using testing::Untouched;

std::string BuiltIn(const std::string& name) {
  const char* const root = std::getenv("TACTUS_SOURCE_DIR");
  return absl::StrCat(root == nullptr ? "." : root, "/server/registry/", name);
}

// A skin and what it reads; an empty frame ends a trial.
struct Play {
  Skin skin;
  std::vector<Frame> frames;
};

Play Touches() {
  Play play = {.skin = CodySkin(), .frames = {}};
  uint64_t sequence = 0;
  for (int trial = 0; trial < 2; ++trial) {
    auto frames = testing::Contact(60, 10 + trial);
    frames.resize(130, Untouched());
    for (const testing::Counts& counts : frames) {
      play.frames.push_back(CodyFrame(++sequence, counts));
      // Some are lost.
      if (sequence % 50 == 0) play.frames.back().missing_before = 2;
    }
    play.frames.emplace_back();
  }
  return play;
}

Play SimulatedContacts() {
  const auto driver =
      ExposeDriver(std::make_shared<SimDriver>(SimDriver::Options{.seed = 5},
                                               /*trials=*/3, Shard{}));
  Play play = {.skin = *driver->Configure(), .frames = {}};
  EXPECT_TRUE(driver->Activate().ok());
  for (Frame frame;;) {
    const ReadResult result = *driver->Read(frame);
    if (result == ReadResult::kEndOfData) return play;
    play.frames.push_back(result == ReadResult::kFrame ? frame : Frame());
  }
}

// Finals and events, in order; `record` has all answers.
std::vector<std::string> Run(Stream& stream, const Play& play) {
  std::vector<std::string> finals;
  for (const Frame& frame : play.frames) {
    if (!frame.values.empty()) {
      const absl::Status status = stream.Push(frame);
      EXPECT_TRUE(status.ok()) << status;
      continue;
    }
    const auto answer = stream.EndTrial();
    EXPECT_TRUE(answer.ok()) << answer.status();
    if (answer.ok()) finals.push_back(AllOf(*answer));
  }
  EXPECT_TRUE(stream.Close().ok());
  for (const std::string& event : PollAll(stream)) finals.push_back(event);
  return finals;
}

void ExpectTheSame(const std::string& address, const Play& play,
                   const std::string& model, const std::string& file,
                   const StreamOptions& options) {
  Record there;
  Record here;
  StreamOptions remote = options;
  remote.model = model;
  remote.on_answer = there.Options().on_answer;
  StreamOptions local = options;
  local.on_answer = here.Options().on_answer;
  const auto classifier = Classifier::Load(BuiltIn(file));
  ASSERT_TRUE(classifier.ok()) << classifier.status();
  const auto served = Client(address).Open(play.skin, remote);
  ASSERT_TRUE(served.ok()) << served.status();
  const auto computed = classifier->Open(play.skin, local);
  ASSERT_TRUE(computed.ok()) << computed.status();
  EXPECT_EQ((*computed)->info().model_sha256, (*served)->info().model_sha256);
  const std::vector<std::string> finals = Run(**computed, play);
  EXPECT_GE(finals.size(), 4u);
  EXPECT_EQ(Run(**served, play), finals);
  // The server may leave out interim answers.
  std::map<std::pair<uint64_t, bool>, std::string> by_frame;
  for (const Answer& answer : here.answers()) {
    by_frame[{answer.sequence, answer.is_final}] = AllOf(answer);
  }
  EXPECT_GE(there.answers().size(), 4u);
  for (const Answer& answer : there.answers()) {
    const auto found = by_frame.find({answer.sequence, answer.is_final});
    ASSERT_NE(found, by_frame.end());
    EXPECT_EQ(AllOf(answer), found->second);
  }
}

TEST(ClassifierTest, AServerAndThisProcessGiveTheSameBits) {
  const testing::RestartedServer server;
  const Play touches = Touches();
  const Play simulated = SimulatedContacts();
  ExpectTheSame(server.address(), touches, "no-poses", "no-poses.tactus",
                {.with_taxels = true});
  ExpectTheSame(server.address(), touches, "no-poses", "no-poses.tactus",
                {.cadence = Cadence::kOnChange,
                 .release_after = std::chrono::milliseconds(100),
                 .low_effort = true});
  ExpectTheSame(server.address(), simulated, "default", "default.tactus", {});
  ExpectTheSame(server.address(), simulated, "default", "default.tactus",
                {.interval_frames = 3,
                 .decision_threshold = 0.7,
                 .decision_frames = 3,
                 .never_release = true,
                 .max_contacts = 1});
}

LocalModel SmallLocalModel() {
  return {.model = *CompiledModel::Create(testing::SmallModel()),
          .version = "small",
          .sha256 = ""};
}

TEST(ClassifierTest, AWrongFrameEndsTheStreamAsAServerDoes) {
  Skin skin = CodySkin();
  skin.encoding = TaxelEncoding::kFloat32;
  auto stream = *OpenLocalStream(SmallLocalModel(), skin, {});
  ASSERT_TRUE(stream->Push(CodyFrame(2, Touch(1))).ok());
  EXPECT_FALSE(stream->ended());
  const absl::Status late = stream->Push(CodyFrame(1, Touch(1)));
  EXPECT_EQ(ReasonOf(late), "TIME_REGRESSION");
  EXPECT_TRUE(stream->ended());
  EXPECT_EQ(stream->Push(CodyFrame(3, Touch(1))), late);
  EXPECT_EQ(stream->EndTrial().status(), late);
  EXPECT_EQ(stream->Close(), late);
}

TEST(ClassifierTest, AShearedContactIsFelt) {
  const Skin skin = {.name = "pad",
                     .rows = 4,
                     .columns = 4,
                     .row_pitch_m = 0.005,
                     .column_pitch_m = 0.005,
                     .taxel_area_m2 = 25e-6,
                     .contact_threshold = 1,
                     .onset_threshold = 2,
                     .axes = 3,
                     .normal_axis = 2,
                     .signed_values = true,
                     .encoding = TaxelEncoding::kInt16};
  auto stream = *OpenLocalStream(SmallLocalModel(), skin, {});
  EXPECT_EQ(stream->info().axes, 3);
  Frame frame;
  frame.values.assign(48, 0);
  frame.values[3 * 5] = -7;
  frame.values[3 * 5 + 2] = 4;
  ASSERT_TRUE(stream->Push(frame).ok());
  const auto answer = stream->EndTrial();
  ASSERT_TRUE(answer.ok()) << answer.status();
  ASSERT_NE(answer->main(), nullptr);
  EXPECT_EQ(answer->main()->patch->force, 4);
}

TEST(ClassifierTest, AfterTheEndCallsSaySo) {
  Record record;
  auto stream =
      *OpenLocalStream(SmallLocalModel(), CodySkin(), record.Options());
  ASSERT_TRUE(stream->Push(CodyFrame(1, Touch(1))).ok());
  EXPECT_TRUE(stream->Close().ok());
  EXPECT_TRUE(stream->Close().ok());
  EXPECT_TRUE(record.answers().back().is_final);
  EXPECT_EQ(ReasonOf(stream->Push(CodyFrame(2, Touch(1)))), "STREAM_FINISHED");
  auto cancelled = *OpenLocalStream(SmallLocalModel(), CodySkin(), {});
  cancelled->Cancel();
  EXPECT_TRUE(cancelled->ended());
  EXPECT_EQ(ReasonOf(cancelled->Push(CodyFrame(1, Touch(1)))), "CANCELLED");
  EXPECT_EQ(ReasonOf(cancelled->Close()), "CANCELLED");
}

TEST(ClassifierTest, ErrorsNameWhatIsWrong) {
  const absl::Status absent = Classifier::Load("/none.tactus").status();
  EXPECT_EQ(ReasonOf(absent), "IO");
  EXPECT_THAT(absent.message(), HasSubstr("/none.tactus"));
  const ScratchDir scratch;
  const std::string path = scratch / "bad.tactus";
  std::ofstream(path) << "no model";
  const absl::Status damaged = Classifier::Load(path).status();
  EXPECT_EQ(ReasonOf(damaged), "BUNDLE_CORRUPT");
  EXPECT_THAT(damaged.message(), HasSubstr("bad.tactus"));
  const auto classifier = Classifier::Load(BuiltIn("default.tactus"));
  ASSERT_TRUE(classifier.ok()) << classifier.status();
  EXPECT_EQ(ReasonOf(classifier->Open(CodySkin(), {.model = "pads"}).status()),
            "INVALID_CONFIG");
  // It needs poses.
  EXPECT_EQ(ReasonOf(classifier->Open(CodySkin()).status()), "INVALID_CONFIG");
  EXPECT_EQ(
      ReasonOf(
          classifier->Open({.name = "icub-6x10", .with_poses = true}).status()),
      "GEOMETRY_MISMATCH");
}

}  // namespace
}  // namespace tactus::internal::client

// Drivers and TrialPlayer against an in-process server.
#include "tools/stream/trial_player.h"

#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <sstream>

#include "client/drivers/replay_driver.h"
#include "client/drivers/sim_driver.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/data/trial_file.h"
#include "gtest/gtest.h"
#include "tests/server/support/test_server.h"
#include "tools/common/percentile.h"
#include "tools/stream/report.h"

namespace tactus::internal::client {
namespace {

using testing::TestServer;

// Plays trials from memory.
class MemoryDriver : public TrialDriver {
 public:
  explicit MemoryDriver(std::vector<Trial> trials)
      : TrialDriver({}, trials.size()), trials_(std::move(trials)) {}

 protected:
  absl::StatusOr<Trial> MakeTrial(size_t index) override {
    return trials_[index];
  }

 private:
  std::vector<Trial> trials_;
};

// A contact as u16 or f32, with or without poses.
Trial MakeTrial(uint64_t seed, bool u16, bool poses) {
  Trial trial;
  trial.id = std::to_string(100'000 + seed);
  trial.label = "SU";
  trial.condition = "c";
  trial.layout = "cody-forearm";
  trial.taxels.rows = 16;
  trial.taxels.columns = 24;
  if (u16) trial.taxels.scale = 0.001;
  Random random(seed);
  const auto contact = testing::Contact(60, seed);
  for (size_t t = 0; t < contact.size(); ++t) {
    trial.time.push_back(0.3 + 0.01 * static_cast<double>(t));
    if (u16) {
      trial.taxels.u16.insert(trial.taxels.u16.end(), contact[t].begin(),
                              contact[t].end());
    } else {
      const auto values = testing::Newtons(contact[t]);
      trial.taxels.f32.insert(trial.taxels.f32.end(), values.begin(),
                              values.end());
    }
    if (poses) {
      Pose pose;
      pose.position = {random.Gaussian(), 0.1, 0.2};
      trial.poses.push_back(pose);
    }
  }
  return trial;
}

// The offline answer: frames straight into the pipeline.
std::vector<double> Offline(const TestServer& server, const Trial& trial) {
  ContactPipeline::Options options;
  auto pipeline = *ContactPipeline::Create(*LayoutPreset(trial.layout),
                                           server.models().model(), options);
  std::vector<float> taxels(trial.taxels.rows * trial.taxels.columns);
  for (size_t t = 0; t < trial.time.size(); ++t) {
    trial.taxels.Decode(t, taxels.data());
    FrameView frame{.taxels = taxels};
    if (!trial.poses.empty()) frame.pose = &trial.poses[t];
    pipeline->Step(frame);
  }
  if (pipeline->main_contact() == nullptr) return {};
  const auto likelihood =
      pipeline->main_contact()->classifier->log_likelihood();
  return {likelihood.begin(), likelihood.end()};
}

TEST(TrialPlayerTest, AnswersAreTheOfflineOnesBitForBit) {
  TestServer server;
  for (const bool u16 : {false, true}) {
    for (const bool poses : {false, true}) {
      for (const bool sparse : {false, true}) {
        for (const uint32_t batch : {1u, 7u, 64u}) {
          std::vector<Trial> trials;
          for (uint64_t seed = 1; seed <= 3; ++seed) {
            trials.push_back(MakeTrial(seed, u16, poses));
          }
          MemoryDriver driver(trials);
          size_t seen = 0;
          TrialPlayer player(server.channel(), &driver,
                             {.model = "", .sparse = sparse, .batch = batch},
                             [&](const TrialResult& result) {
                               EXPECT_EQ(result.index, seen);
                               EXPECT_TRUE(result.detected);
                               EXPECT_EQ(result.label, 2);
                               EXPECT_EQ(result.log_likelihood,
                                         Offline(server, trials[seen]));
                               ++seen;
                             });
          const absl::Status status = player.Run();
          EXPECT_TRUE(status.ok()) << status;
          EXPECT_EQ(seen, 3u);
          EXPECT_EQ(player.totals().frames, 180u);
          EXPECT_EQ(player.totals().lost, 0u);
          EXPECT_FALSE(player.totals().rtt_us.empty());
          EXPECT_EQ(driver.state(), DriverState::kInactive);
        }
      }
    }
  }
}

TEST(TrialPlayerTest, RealTimeLosesNothing) {
  TestServer server;
  Trial trial = MakeTrial(1, true, false);
  // A hundredth of the time.
  for (double& time : trial.time) time /= 100;
  MemoryDriver driver({trial, trial});
  int seen = 0;
  TrialPlayer player(server.channel(), &driver,
                     {.model = "", .real_time = true},
                     [&](const TrialResult&) { ++seen; });
  ASSERT_TRUE(player.Run().ok());
  EXPECT_EQ(seen, 2);
  EXPECT_EQ(player.totals().lost, 0u);
}

TEST(TrialPlayerTest, ALabelTheModelDoesNotKnowIsAnError) {
  TestServer server;
  Trial trial = MakeTrial(1, true, false);
  trial.label = "wet";
  MemoryDriver driver({trial});
  TrialPlayer player(server.channel(), &driver, {}, [](const TrialResult&) {});
  const absl::Status status = player.Run();
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG") << status;
}

TEST(TrialPlayerTest, TheServersEndIsReportedWithItsReason) {
  TestServer server(TestServer::OnLoopback(0));
  std::vector<Trial> trials(200, MakeTrial(1, true, false));
  MemoryDriver driver(std::move(trials));
  std::thread stop;
  TrialPlayer player(server.channel(), &driver, {},
                     [&](const TrialResult& result) {
                       if (result.index == 2) {
                         stop = std::thread([&] { server.server().Stop(); });
                       }
                     });
  const absl::Status status = player.Run();
  stop.join();
  EXPECT_EQ(ReasonOf(status), "DRAINING") << status;
}

TEST(TrialDriverTest, LifecycleIsEnforced) {
  MemoryDriver driver({MakeTrial(1, true, false)});
  SkinFrame frame;
  EXPECT_FALSE(driver.Read(frame).ok());
  EXPECT_FALSE(driver.Activate().ok());
  ASSERT_TRUE(driver.Configure().ok());
  EXPECT_FALSE(driver.Configure().ok());
  EXPECT_FALSE(driver.Read(frame).ok());
  ASSERT_TRUE(driver.Activate().ok());
  EXPECT_EQ(*driver.Read(frame), ReadResult::kFrame);
  ASSERT_TRUE(driver.Deactivate().ok());
  EXPECT_EQ(driver.state(), DriverState::kInactive);
}

TEST(TrialDriverTest, TimeGoesOnAcrossTrials) {
  MemoryDriver driver({MakeTrial(1, true, false), MakeTrial(2, true, false)});
  ASSERT_TRUE(driver.Configure().ok());
  ASSERT_TRUE(driver.Activate().ok());
  SkinFrame frame;
  int64_t last = -1;
  int ends = 0;
  for (ReadResult r = ReadResult::kFrame; r != ReadResult::kEndOfData;) {
    r = *driver.Read(frame);
    ends += r == ReadResult::kEndOfTrial;
    if (r != ReadResult::kFrame) continue;
    EXPECT_GT(frame.capture_time_ns, last);
    last = frame.capture_time_ns;
  }
  EXPECT_EQ(ends, 2);
}

TEST(TrialDriverTest, RefusesMixedAndTaxelFreeTrials) {
  MemoryDriver mixed({MakeTrial(1, true, false), MakeTrial(2, false, false)});
  ASSERT_TRUE(mixed.Configure().ok());
  ASSERT_TRUE(mixed.Activate().ok());
  SkinFrame frame;
  absl::Status status;
  while (status.ok()) status = mixed.Read(frame).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_TRAINING_DATA");
  Trial bare = MakeTrial(1, true, false);
  bare.taxels = {};
  MemoryDriver empty({bare});
  EXPECT_FALSE(empty.Configure().ok());
}

TEST(ReplayDriverTest, PlaysAFileInShards) {
  const std::string path = ::testing::TempDir() + "replay_driver_test.h5";
  {
    auto writer = *TrialFileWriter::Create(path, {.overwrite = true});
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      ASSERT_TRUE(writer.Append(MakeTrial(seed, true, true)).ok());
    }
    ASSERT_TRUE(writer.Close().ok());
  }
  TestServer server;
  std::map<size_t, std::vector<double>> got;
  for (size_t shard = 0; shard < 2; ++shard) {
    ReplayDriver driver(path, {shard, 2}, {});
    TrialPlayer player(server.channel(), &driver, {},
                       [&](const TrialResult& result) {
                         got[result.index] = result.log_likelihood;
                       });
    const absl::Status status = player.Run();
    ASSERT_TRUE(status.ok()) << status;
  }
  ASSERT_EQ(got.size(), 5u);
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    EXPECT_EQ(got[seed - 1], Offline(server, MakeTrial(seed, true, true)));
  }
  std::remove(path.c_str());
  ReplayDriver gone(path, {}, {});
  EXPECT_FALSE(gone.Configure().ok());
}

TEST(ReplayDriverTest, PlaysASkinThatIsNoPreset) {
  const std::string path = ::testing::TempDir() + "replay_own_skin.h5";
  Trial trial = MakeTrial(1, true, false);
  trial.layout = "my-palm";
  {
    auto writer = *TrialFileWriter::Create(path, {.overwrite = true});
    ASSERT_TRUE(writer.Append(trial).ok());
    ASSERT_TRUE(writer.Close().ok());
  }
  ReplayDriver without(path, {}, {});
  const absl::Status status = without.Configure().status();
  EXPECT_EQ(ReasonOf(status), "UNKNOWN_LAYOUT") << status;
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.name = "my-palm";
  ReplayDriver with(path, {}, {.layout = layout});
  const auto info = with.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout, layout);
  layout.rows = 8;
  ReplayDriver wrong(path, {}, {.layout = layout});
  EXPECT_EQ(ReasonOf(wrong.Configure().status()), "INVALID_CONFIG");
  std::remove(path.c_str());
}

TEST(TrialPlayerTest, TrialsOfAnotherSkinAreRefused) {
  TestServer server;
  SkinLayout skin = *LayoutPreset("vitac-12x32");
  for (const double onset : {40.0, 50.0}) {
    Trial trial;
    trial.id = "000007";
    trial.label = "SU";
    skin.onset_threshold = onset;
    SetSkin(skin, trial);
    trial.taxels.SetShape(skin);
    trial.taxels.f32.assign(3 * 384, 45);
    trial.time = {0, 0.01, 0.02};
    MemoryDriver driver({trial});
    TrialPlayer player(server.channel(), &driver, {.model = "models/vitac"},
                       [](const TrialResult&) {});
    const absl::Status status = player.Run();
    EXPECT_EQ(status.ok(), onset == 40) << status;
    if (onset == 40) continue;
    EXPECT_EQ(ReasonOf(status), "GEOMETRY_MISMATCH");
    EXPECT_NE(status.message().find("onset_threshold 50, not 40"),
              std::string::npos)
        << status;
  }
}

TEST(ReplayDriverTest, PlaysTheSkinThatTrialsCarry) {
  const std::string path = ::testing::TempDir() + "replay_carried_skin.h5";
  SkinLayout layout = *LayoutPreset("cody-forearm");
  layout.name = "my-palm";
  Trial trial = MakeTrial(1, true, false);
  SetSkin(layout, trial);
  {
    auto writer = *TrialFileWriter::Create(path, {.overwrite = true});
    ASSERT_TRUE(writer.Append(trial).ok());
    ASSERT_TRUE(writer.Close().ok());
  }
  ReplayDriver driver(path, {}, {});
  const auto info = driver.Configure();
  ASSERT_TRUE(info.ok()) << info.status();
  EXPECT_EQ(info->layout, layout);
  std::remove(path.c_str());
}

TEST(TrialPlayerTest, ADriverWithoutTrialsIsNoError) {
  TestServer server;
  MemoryDriver driver({});
  TrialPlayer player(server.channel(), &driver, {}, [](const TrialResult&) {});
  const absl::Status status = player.Run();
  EXPECT_TRUE(status.ok()) << status;
  EXPECT_EQ(player.totals().frames, 0u);
}

TEST(SimDriverTest, MakesTheSameClassesForAnyNumberOfShards) {
  std::map<size_t, Trial> whole;
  for (const size_t shards : {1, 2}) {
    for (size_t shard = 0; shard < shards; ++shard) {
      SimDriver driver({.seed = 3}, 4, {shard, shards});
      ASSERT_TRUE(driver.Configure().ok());
      ASSERT_TRUE(driver.Activate().ok());
      SkinFrame frame;
      while (*driver.Read(frame) != ReadResult::kEndOfData) {
        const Trial& trial = driver.trial();
        const auto [entry, is_new] = whole.emplace(driver.trial_index(), trial);
        EXPECT_EQ(entry->second.taxels.u16, trial.taxels.u16);
      }
    }
  }
  ASSERT_EQ(whole.size(), 4u);
  const char* const labels[] = {"HU", "HM", "SU", "SM"};
  for (const auto& [index, trial] : whole) {
    EXPECT_EQ(trial.label, labels[index]);
    EXPECT_EQ(trial.layout, "cody-forearm");
    EXPECT_EQ(trial.poses.size(), trial.time.size());
  }
}

TEST(ReportTest, CountsUndetectableTrialsApart) {
  Report report(stderr);
  report.SetClassNames({"HU", "HM"});
  const auto add = [&](size_t index, int label, int answer, bool detected,
                       double decision_ms) {
    TrialResult result;
    result.index = index;
    result.id = std::to_string(index);
    result.label = label;
    result.answer = answer;
    result.detected = detected;
    result.probability = {0.1, 0.9};
    result.log_likelihood = {-1.0 / 3, -2};
    if (decision_ms > 0) {
      result.decision = answer;
      result.decision_ms = decision_ms;
    }
    report.Add(result);
  };
  add(2, 0, 0, true, 100);
  add(0, 0, 1, true, 300);
  add(1, 1, 1, true, 0);
  add(3, 1, 0, false, 0);
  report.AddTotals({.frames = 10, .lost = 1, .rtt_us = {5, 1, 3}});
  const auto json = report.ToJson();
  EXPECT_EQ(JsonText(json),
            "{\"trials\":4,\"felt\":3,\"never_felt\":1,\"right\":2,"
            "\"wrong\":1,\"decided_right\":1,\"decided_wrong\":1,"
            "\"undecided\":1,\"accuracy\":0.6666666666666666,\"classes\":["
            "{\"trials\":2,\"felt\":2,\"never_felt\":0,\"right\":1,"
            "\"wrong\":1,\"decided_right\":1,\"decided_wrong\":1,"
            "\"undecided\":0,\"name\":\"HU\",\"words\":\"hard-unmoved\"},"
            "{\"trials\":2,\"felt\":1,\"never_felt\":1,\"right\":1,"
            "\"wrong\":0,\"decided_right\":0,\"decided_wrong\":0,"
            "\"undecided\":1,\"name\":\"HM\",\"words\":\"hard-moved\"}],"
            "\"confusion\":"
            "[[1,1],[0,1]],\"decision_ms\":{\"p50\":100.0,\"p90\":300.0},"
            "\"rtt_us\":{\"p50\":3.0,\"p99\":5.0},\"frames\":10,\"lost\":1,"
            "\"undetectable\":1,\"resumed\":0}");
  const std::string path = ::testing::TempDir() + "report_test.jsonl";
  ASSERT_TRUE(report.WritePosteriors(path).ok());
  std::ifstream file(path);
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  EXPECT_EQ(line,
            "{\"trial\":\"0\",\"probability\":[0.10000000000000001,"
            "0.90000000000000002],\"log_likelihood\":[-0.33333333333333331,"
            "-2]}");
  std::remove(path.c_str());
}

TEST(PercentileTest, TakesTheNearestRank) {
  EXPECT_TRUE(std::isnan(Percentile({}, 0.5)));
  EXPECT_EQ(Percentile({4, 1, 3, 2}, 0.5), 2);
  EXPECT_EQ(Percentile({4, 1, 3, 2}, 0.99), 4);
  EXPECT_EQ(Percentile({4, 1, 3, 2}, 0), 1);
}

}  // namespace
}  // namespace tactus::internal::client

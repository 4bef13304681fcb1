// A stream whose frames came at another rate than its config said got answers
// without a word, and so did trials of a file.
#include <algorithm>

#include "core/base/rate_watch.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "server/session/stream_session.h"
#include "tests/core/import/import_all.h"
#include "tests/server/support/requests.h"
#include "tests/server/support/test_models.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

constexpr int64_t kSecond = 1'000'000'000;

// How often a watch speaks of `seconds` of frames at `hz`, in batches.
int Words(RateWatch& watch, double hz, int seconds, uint32_t batch,
          int64_t begin_ns = 0) {
  int words = 0;
  const auto frames = static_cast<int64_t>(hz * seconds);
  for (int64_t i = 0; i < frames; i += batch) {
    words += watch.Add(
        batch, begin_ns + static_cast<int64_t>(static_cast<double>(i) / hz *
                                               static_cast<double>(kSecond)));
  }
  return words;
}

TEST(RateThatNobodyComparesTest, AnotherRateIsFoundOnce) {
  for (const double hz : {50.0, 94.0, 106.0, 200.0, 5000.0}) {
    for (const uint32_t batch : {1U, 8U}) {
      RateWatch watch(100);
      EXPECT_EQ(Words(watch, hz, 20, batch), 1) << hz;
      EXPECT_TRUE(watch.differs());
      EXPECT_NEAR(watch.measured_hz(), hz, hz * 0.01);
    }
  }
}

// Microseconds in the place of nanoseconds.
TEST(RateThatNobodyComparesTest, SoIsAnotherUnit) {
  RateWatch watch(100);
  int words = 0;
  for (int64_t i = 0; i < 1000; ++i) words += watch.Add(1, i * 10'000);
  EXPECT_EQ(words, 1);
}

TEST(RateThatNobodyComparesTest, TheStatedRateIsNoNews) {
  for (const double hz : {96.0, 100.0, 104.0}) {
    RateWatch watch(100);
    EXPECT_EQ(Words(watch, hz, 20, 1), 0) << hz;
  }
}

// A robot that stops sending for a while, or a trial that ends.
TEST(RateThatNobodyComparesTest, PausesAreNoNews) {
  RateWatch watch(100);
  int words = 0;
  for (int64_t part = 0; part < 20; ++part) {
    words += Words(watch, 100, 3, 1, part * 10 * kSecond);
    if (part > 10) watch.Pause();
  }
  EXPECT_EQ(words, 0);
}

// Contacts of a third of a second, with nothing sent in between.
TEST(RateThatNobodyComparesTest, NorAreBursts) {
  RateWatch watch(100);
  int words = 0;
  int64_t now_ns = 0;
  for (int contact = 0; contact < 30; ++contact) {
    for (int i = 0; i < 33; ++i) words += watch.Add(1, now_ns += 10'000'000);
    now_ns += 2 * kSecond;
  }
  EXPECT_EQ(words, 0);
}

// Each third frame is lost, and its number says so.
TEST(RateThatNobodyComparesTest, LostFramesAreNoNews) {
  RateWatch watch(100);
  int words = 0;
  for (int64_t i = 0; i < 900; i += 3) {
    words += watch.Add(1, i * 10'000'000, 1);
    words += watch.Add(1, (i + 1) * 10'000'000);
  }
  EXPECT_EQ(words, 0);
}

// Times that are late by up to 60 ms, as of a busy computer.
TEST(RateThatNobodyComparesTest, LateFramesAreNoNews) {
  RateWatch watch(100);
  int words = 0;
  int64_t now_ms = 0;
  for (int64_t i = 0; i < 5000; ++i) {
    const int64_t late_ms = (i * i * 7919 + i * 104'729) % 61;
    now_ms = std::max(now_ms + 1, i * 10 + late_ms);
    words += watch.Add(1, now_ms * 1'000'000);
  }
  EXPECT_EQ(words, 0);
}

// Trials of less than a window.
TEST(RateThatNobodyComparesTest, ShortTrialsAddUp) {
  RateWatch watch(100);
  int words = 0;
  for (int64_t trial = 0; trial < 10; ++trial) {
    words += Words(watch, 50, 1, 1, trial * 10 * kSecond);
    watch.Pause();
  }
  EXPECT_EQ(words, 1);
}

// The notices of a stream at 100 Hz whose frames have the times `i` *
// `period_ns`.
std::vector<v1::StreamNotice> Notices(int64_t period_ns, int frames) {
  static const auto* const models = new testing::TestModels();
  server::StreamSession session(models, {});
  std::vector<v1::StreamNotice> notices;
  const auto send = [&](const v1::ClassifyContactRequest& request) {
    EXPECT_TRUE(session.OnRequest(request).ok());
    while (const auto* answer = session.responses().StartWrite(0)) {
      if (answer->has_notice()) notices.push_back(answer->notice());
      session.responses().FinishWrite();
    }
  };
  send(testing::ConfigRequest());
  for (int i = 1; i <= frames; ++i) {
    auto request = testing::DenseU16(i, {testing::Untouched()});
    request.mutable_frames()->set_first_capture_time_ns(i * period_ns);
    send(request);
  }
  return notices;
}

TEST(RateThatNobodyComparesTest, AStreamGetsOneNotice) {
  EXPECT_TRUE(Notices(10'000'000, 400).empty());
  const auto slow = Notices(20'000'000, 400);
  ASSERT_EQ(slow.size(), 1U);
  EXPECT_EQ(slow[0].kind(), v1::StreamNotice::KIND_RATE_DIFFERS);
  EXPECT_NEAR(slow[0].measured_rate_hz(), 50, 0.1);
  EXPECT_EQ(slow[0].stated_rate_hz(), 100);
  // The first second of it is enough.
  EXPECT_EQ(Notices(20'000'000, 60).size(), 1U);
  // Milliseconds in the place of nanoseconds.
  const auto unit = Notices(10, 400);
  ASSERT_EQ(unit.size(), 1U);
  EXPECT_NEAR(unit[0].measured_rate_hz(), 1e8, 1e5);
}

// A trial file whose trials say 100 Hz and have the times of `hz`.
absl::StatusOr<std::vector<Trial>> ImportFileOf(double hz,
                                                std::string* remarks) {
  const ScratchDir dir;
  const std::string path = dir.path() + "/trials.h5";
  Trial trial;
  trial.label = "a";
  trial.id = "one";
  for (int i = 0; i < 100; ++i) {
    trial.time.push_back(i / hz);
    trial.signals.push_back({1, 1, 1});
  }
  auto writer = TrialFileWriter::Create(path, {});
  EXPECT_TRUE(writer.ok() && writer->Append(trial).ok() &&
              writer->Close().ok());
  ImportOptions options;
  options.remark = [&](const std::string& text) { *remarks += text; };
  return ImportAll(path, options);
}

TEST(RateThatNobodyComparesTest, TrialsOfAFileHaveTheRateThatTheyState) {
  std::string remarks;
  EXPECT_TRUE(ImportFileOf(100, &remarks).ok());
  EXPECT_EQ(remarks, "");
  EXPECT_TRUE(ImportFileOf(90, &remarks).ok());
  EXPECT_THAT(remarks, ::testing::HasSubstr("another rate than 100 Hz: 90"));
  EXPECT_THAT(std::string(ImportFileOf(50, &remarks).status().message()),
              ::testing::AllOf(::testing::HasSubstr("trial one"),
                               ::testing::HasSubstr("is 100, but the times "
                                                    "are those of 50 frames")));
}

}  // namespace
}  // namespace tactus::internal

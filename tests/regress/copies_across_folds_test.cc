// Trials that a file holds twice were dealt to different folds: each was tested
// by a model that was fitted to its copy, and random labels came out at 98 %.
#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/random.h"
#include "core/contacts/copies.h"
#include "core/contacts/folds.h"
#include "core/data/frame_fingerprint.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using client::Json;
using ::testing::HasSubstr;
using testing::RunTrainctl;

constexpr int kRecordings = 60;
constexpr int kFrames = 30;

// A contact of random shape, whose label means nothing.
Trial RandomTrial(int number) {
  Random random(static_cast<uint64_t>(number) + 1);
  const double force = 1 + random.Uniform();
  const double area = 1e-4 * (1 + random.Uniform());
  const double rise = 2 + 10 * random.Uniform();
  Trial trial;
  trial.label = random.Uniform() < 0.5 ? "a" : "b";
  trial.condition = number % 2 == 0 ? "slow" : "fast";
  trial.material = number % 3 == 0 ? "wood" : "foam";
  for (int t = 0; t < kFrames; ++t) {
    const double load = std::min(1.0, (t + 1) / rise);
    trial.time.push_back(0.01 * t);
    trial.signals.push_back({force * load, area * load, 1e-3 * load * force});
  }
  return trial;
}

class CopiesAcrossFoldsTest : public ::testing::Test {
 protected:
  // Each recording `copies` times, under other ids and conditions.
  std::string Write(const std::string& name, int copies) {
    auto writer = TrialFileWriter::Create(folder_ / name, {});
    for (int copy = 0; copy < copies; ++copy) {
      for (int i = 0; i < kRecordings; ++i) {
        Trial trial = RandomTrial(i);
        if (copy > 0) trial.condition = "again";
        trial.source = "r" + std::to_string(i) + ".csv";
        EXPECT_TRUE(writer->Append(trial).ok());
      }
    }
    EXPECT_TRUE(writer->Close().ok());
    return folder_ / name;
  }

  const ScratchDir folder_;
};

TEST_F(CopiesAcrossFoldsTest, RandomLabelsStayAtChance) {
  const std::string data = Write("twice.h5", 2);
  for (const char* protocol : {"k-fold", "leave-one-out"}) {
    ::testing::internal::CaptureStderr();
    const auto run = RunTrainctl("evaluate --json --algorithm=1nn --protocol=" +
                                 std::string(protocol) + " --data=" + data);
    const std::string remarks = ::testing::internal::GetCapturedStderr();
    ASSERT_TRUE(run.status.ok()) << run.status;
    const Json json = Json::parse(run.out);
    EXPECT_EQ(json["felt"], 2 * kRecordings);
    // Four standard deviations of 60 fair coins.
    EXPECT_LT(json["accuracy"].get<double>(), 0.5 + 4 * 0.5 / std::sqrt(60.0))
        << protocol;
    EXPECT_EQ(json["trained_on_data"], false);
    EXPECT_THAT(remarks, HasSubstr("60 of the trials have frames"));
    EXPECT_THAT(remarks, HasSubstr("r0.csv"));
  }
}

TEST_F(CopiesAcrossFoldsTest, NoFoldHasACopyOnBothSides) {
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 3 * kRecordings; ++i) {
    Trial trial = RandomTrial(i % kRecordings);
    // Copies under another condition, material and label.
    trial.condition = std::to_string(i % 7);
    trial.material = std::to_string(i % 11);
    trial.label = i % 5 == 0 ? "c" : trial.label;
    contacts.push_back(**ExtractContact(trial));
    contacts.back().fingerprint = FrameFingerprint(trial);
  }
  std::vector<const LabelledContact*> pointers;
  for (const auto& contact : contacts) pointers.push_back(&contact);
  EXPECT_EQ(FindCopies(pointers).size(), 2u * kRecordings);
  for (const char* name :
       {"k-fold", "leave-one-out", "loco", "leave-one-material-out"}) {
    const auto folds = MakeFolds(pointers, *ParseProtocol(name));
    ASSERT_TRUE(folds.ok()) << name;
    std::multiset<int> tested;
    for (const std::vector<int>& fold : *folds) {
      tested.insert(fold.begin(), fold.end());
      std::set<std::string> inside;
      for (const int i : fold) inside.insert(contacts[i].fingerprint);
      for (const int i : Complement(fold, 3 * kRecordings)) {
        EXPECT_FALSE(inside.contains(contacts[i].fingerprint)) << name;
      }
    }
    EXPECT_EQ(tested.size(), 3u * kRecordings) << name;
    EXPECT_EQ(std::set<int>(tested.begin(), tested.end()).size(),
              3u * kRecordings)
        << name;
  }
}

}  // namespace
}  // namespace tactus::internal

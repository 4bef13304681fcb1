#include "core/base/ranks.h"

#include <atomic>
#include <map>
#include <mutex>
#include <set>

#include "core/base/errors.h"
#include "core/base/run_on_threads.h"
#include "core/bundle/model_proto.h"
#include "core/eval/auto_preset.h"
#include "core/train/fit.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"
#include "tests/support/thread_ranks.h"

namespace tactus::internal {
namespace {

using testing::PointersTo;
using testing::RunAsRanks;

TEST(ShareOutTest, GivesTheHeaviestToWhoHasLeast) {
  EXPECT_EQ(ShareOut(std::vector<double>{1, 5, 2, 3}, 2),
            (std::vector<int>{0, 0, 1, 1}));
  EXPECT_EQ(ShareOut(std::vector<double>{1, 1, 1}, 2),
            (std::vector<int>{0, 1, 0}));
  EXPECT_EQ(ShareOut(std::vector<double>{1, 1}, 5), (std::vector<int>{0, 1}));
  EXPECT_TRUE(ShareOut({}, 3).empty());
}

// The folder that all ranks of a job share.
class SharedParts {
 public:
  std::optional<std::string> Find(const std::string& part) {
    const std::lock_guard lock(mutex_);
    const auto found = parts_.find(part);
    if (found == parts_.end()) return std::nullopt;
    return found->second;
  }
  void Put(const std::string& part, std::string bytes) {
    const std::lock_guard lock(mutex_);
    parts_[part] = std::move(bytes);
  }
  size_t size() const { return parts_.size(); }

 private:
  std::mutex mutex_;
  std::map<std::string, std::string> parts_;
};

// The journal of one rank.
class RankJournal : public FitJournal {
 public:
  explicit RankJournal(SharedParts& parts) : parts_(parts) {}

  std::optional<std::string> Find(absl::string_view part) override {
    return parts_.Find(std::string(part));
  }
  absl::Status Put(absl::string_view part, std::string bytes) override {
    const std::lock_guard lock(mutex_);
    if (++puts_ == fail_put_at) return IoError(part, "the disk is full");
    parts_.Put(std::string(part), std::move(bytes));
    put.insert(std::string(part));
    return absl::OkStatus();
  }
  void OnPoint(const LearningPoint& point) override {
    const std::lock_guard lock(mutex_);
    points.insert({point.part, point.iteration});
  }
  bool Cancelled() override { return ++questions_ == cancel_at; }

  std::set<std::string> put;
  std::multiset<std::pair<std::string, int>> points;
  int cancel_at = 0;
  int fail_put_at = 0;

 private:
  SharedParts& parts_;
  std::mutex mutex_;
  int puts_ = 0;
  std::atomic<int> questions_ = 0;
};

FitOptions SmallFit(int shards) {
  FitOptions options = *FitPreset("tuned");
  options.states = 2;
  options.hmms_per_class = 2;
  options.max_iterations = 2;
  options.variations.copies = 2;
  options.lstm.networks = 2;
  options.lstm.cells = {4};
  options.lstm.estimator_cells = {4};
  options.lstm.stretches = 2;
  options.lstm.training.epochs = 2;
  options.lstm.training.shards = shards;
  return options;
}

class RanksTest : public ::testing::Test {
 protected:
  RanksTest() : contacts_(testing::SyntheticContacts(4, 30, 0.1, 1)) {
    for (LabelledContact& contact : contacts_) {
      contact.stiffness = contact.label[0] == 'H' ? 1e6 : 1e3;
      contact.object_motion.assign(contact.frames.size(), 0.0);
    }
  }

  std::string BytesOf(const FitOptions& options, FitJournal* journal = nullptr,
                      const ParallelFor& parallel = RunSerially,
                      Ranks* ranks = nullptr) const {
    const auto model = FitModel(PointersTo(contacts_), options, parallel, {},
                                journal, {}, ranks);
    return model.ok() ? ModelToProto(*model).SerializeAsString()
                      : model.status().ToString();
  }

  std::vector<LabelledContact> contacts_;
};

TEST_F(RanksTest, AnyNumberOfRanksGivesTheSameBytes) {
  for (const int shards : {1, 3}) {
    const FitOptions options = SmallFit(shards);
    const std::string expected = BytesOf(options);
    ASSERT_GT(expected.size(), 1'000u) << expected;
    for (const int size : {1, 2, 3, 4, 11}) {
      for (const int threads : {1, 2}) {
        std::vector<std::string> got(size);
        RunAsRanks(size, [&](Ranks& ranks) {
          got[ranks.rank()] =
              BytesOf(options, nullptr, OnThreads(threads), &ranks);
        });
        for (const std::string& bytes : got) {
          EXPECT_TRUE(bytes == expected) << size << " ranks, " << threads
                                         << " threads, " << shards << " shards";
        }
      }
    }
  }
}

TEST_F(RanksTest, ShardsAreAnotherSumOfTheSameGradients) {
  EXPECT_NE(BytesOf(SmallFit(1)), BytesOf(SmallFit(3)));
}

// Otherwise more ranks would take no less time.
TEST_F(RanksTest, EachPartIsMadeByOneRankAndReportedByOne) {
  for (const int shards : {1, 3}) {
    SharedParts alone_parts;
    RankJournal alone(alone_parts);
    BytesOf(SmallFit(shards), &alone);
    SharedParts parts;
    std::multiset<std::string> put;
    std::multiset<std::pair<std::string, int>> points;
    std::vector<size_t> made;
    std::mutex mutex;
    RunAsRanks(3, [&](Ranks& ranks) {
      RankJournal journal(parts);
      BytesOf(SmallFit(shards), &journal, RunSerially, &ranks);
      const std::lock_guard lock(mutex);
      put.insert(journal.put.begin(), journal.put.end());
      points.insert(journal.points.begin(), journal.points.end());
      made.push_back(journal.put.size());
    });
    for (const std::string& part : alone.put) {
      EXPECT_EQ(put.count(part), 1u) << part;
    }
    EXPECT_EQ(points, alone.points);
    for (const size_t parts_made : made) EXPECT_GT(parts_made, 1u);
  }
}

TEST_F(RanksTest, AFitGoesOnWithAnotherNumberOfRanks) {
  for (const int shards : {1, 3}) {
    const FitOptions options = SmallFit(shards);
    const std::string expected = BytesOf(options);
    for (const int cancel_at : {1, 5, 12, 23, 37}) {
      SharedParts parts;
      std::vector<std::string> ended(2);
      RunAsRanks(2, [&](Ranks& ranks) {
        RankJournal journal(parts);
        if (ranks.rank() == 1) journal.cancel_at = cancel_at;
        ended[ranks.rank()] = BytesOf(options, &journal, RunSerially, &ranks);
      });
      for (const std::string& status : ended) {
        EXPECT_TRUE(status.starts_with("CANCELLED")) << status;
      }
      RunAsRanks(3, [&](Ranks& ranks) {
        RankJournal journal(parts);
        EXPECT_TRUE(BytesOf(options, &journal, RunSerially, &ranks) == expected)
            << cancel_at;
      });
      RankJournal journal(parts);
      EXPECT_TRUE(BytesOf(options, &journal) == expected) << cancel_at;
    }
  }
}

TEST_F(RanksTest, TheErrorOfOneEndsTheFitOfAll) {
  for (int rank = 0; rank < 3; ++rank) {
    SharedParts parts;
    std::vector<std::string> ended(3);
    RunAsRanks(3, [&](Ranks& ranks) {
      RankJournal journal(parts);
      if (ranks.rank() == rank) journal.fail_put_at = 2;
      ended[ranks.rank()] = BytesOf(SmallFit(3), &journal, RunSerially, &ranks);
      // It stays with the ranks.
      EXPECT_EQ(ReasonOf(ranks.Exchange("more").status()), "IO");
    });
    for (const std::string& status : ended) {
      EXPECT_NE(status.find("the disk is full"), std::string::npos) << status;
    }
  }
}

TEST_F(RanksTest, ChooseTheSamePreset) {
  FitOptions good;
  good.hmm_cues = {Cue::kForce};
  good.log_features = false;
  good.states = 2;
  good.max_iterations = 3;
  FitOptions bad = good;
  bad.hmm_cues = {Cue::kMotion};
  // Its classes have too few contacts for so many states.
  FitOptions unfit = good;
  unfit.hmm_cues = CuesOfGroup("load_profile");
  const ChoiceRequest request = {
      .presets = {{"unfit", unfit}, {"bad", bad}, {"good", good}},
      .work_limit = 0};
  const auto contacts = testing::SyntheticContacts(12, 30, 0.05, 1);
  const auto choose = [&](Ranks* ranks) {
    return ChoosePreset(PointersTo(contacts), request, RunSerially, {}, ranks);
  };
  const auto alone = choose(nullptr);
  ASSERT_TRUE(alone.ok()) << alone.status();
  RunAsRanks(2, [&](Ranks& ranks) {
    const auto choice = choose(&ranks);
    ASSERT_TRUE(choice.ok()) << choice.status();
    EXPECT_EQ(choice->name, alone->name);
    ASSERT_EQ(choice->candidates.size(), alone->candidates.size());
    for (size_t i = 0; i < alone->candidates.size(); ++i) {
      EXPECT_EQ(choice->candidates[i].right, alone->candidates[i].right);
      EXPECT_EQ(choice->candidates[i].unfit, alone->candidates[i].unfit);
    }
  });
}

}  // namespace
}  // namespace tactus::internal

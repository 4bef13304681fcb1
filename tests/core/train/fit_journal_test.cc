#include "core/train/fit_journal.h"

#include <atomic>
#include <map>
#include <mutex>
#include <set>

#include "core/base/errors.h"
#include "core/bundle/model_proto.h"
#include "core/train/fit.h"
#include "gtest/gtest.h"
#include "tests/core/eval/synthetic_contacts.h"

namespace tactus::internal {
namespace {

// Keeps parts in memory; cancels at the question number `cancel_at`, from 1.
class MemoryJournal : public FitJournal {
 public:
  std::optional<std::string> Find(absl::string_view part) override {
    const auto found = parts.find(std::string(part));
    if (found == parts.end()) return std::nullopt;
    return found->second;
  }
  absl::Status Put(absl::string_view part, std::string bytes) override {
    ++puts;
    if (puts == fail_put_at) return IoError(part, "the disk is full");
    parts[std::string(part)] = std::move(bytes);
    return absl::OkStatus();
  }
  void OnPoint(const LearningPoint& point) override {
    if (points.empty()) puts_before_points = puts;
    points.push_back(point);
  }
  bool Cancelled() override { return ++questions == cancel_at; }
  bool KeepsParts() const override { return keeps; }

  bool keeps = true;
  std::map<std::string, std::string> parts;
  std::vector<LearningPoint> points;
  int questions = 0;
  int cancel_at = 0;
  int puts = 0;
  int puts_before_points = 0;
  int fail_put_at = 0;
};

FitOptions SmallOptions() {
  FitOptions options = *FitPreset("tuned");
  options.states = 2;
  options.hmms_per_class = 2;
  options.max_iterations = 2;
  options.variations.copies = 2;
  options.lstm.networks = 2;
  options.lstm.cells = {4};
  options.lstm.stretches = 2;
  options.lstm.training.epochs = 2;
  return options;
}

class FitJournalTest : public ::testing::Test {
 protected:
  FitJournalTest() : contacts_(testing::SyntheticContacts(4, 30, 0.1, 1)) {
    for (LabelledContact& contact : contacts_) {
      contact.stiffness = contact.label[0] == 'H' ? 1e6 : 1e3;
      contact.object_motion.assign(contact.frames.size(), 0.0);
    }
    auto whole = Fit(nullptr);
    EXPECT_TRUE(whole.ok()) << whole.status();
    expected_ = *whole;
  }

  // The model's bytes.
  absl::StatusOr<std::string> Fit(FitJournal* journal,
                                  const FitOptions& options = SmallOptions()) {
    const auto model = FitModel(testing::PointersTo(contacts_), options,
                                RunSerially, {}, journal);
    if (!model.ok()) return model.status();
    return ModelToProto(*model).SerializeAsString();
  }

  std::vector<LabelledContact> contacts_;
  std::string expected_;
};

TEST_F(FitJournalTest, CancelledAnywhereItResumesToTheSameBytes) {
  MemoryJournal whole;
  ASSERT_EQ(*Fit(&whole), expected_);
  ASSERT_GT(whole.questions, 60);
  for (int k = 1; k <= whole.questions; k += 5) {
    MemoryJournal journal;
    journal.cancel_at = k;
    const auto cancelled = Fit(&journal);
    ASSERT_EQ(cancelled.status().code(), absl::StatusCode::kCancelled) << k;
    EXPECT_EQ(ReasonOf(cancelled.status()), "CANCELLED");
    journal.questions = 0;
    journal.cancel_at = 0;
    ASSERT_EQ(*Fit(&journal), expected_) << k;
    EXPECT_LE(journal.questions, whole.questions) << k;
  }
}

TEST_F(FitJournalTest, WithoutPartsItWatchesAndCancels) {
  MemoryJournal whole;
  ASSERT_EQ(*Fit(&whole), expected_);
  MemoryJournal watching;
  watching.keeps = false;
  ASSERT_EQ(*Fit(&watching), expected_);
  EXPECT_EQ(watching.puts, 0);
  EXPECT_EQ(watching.points.size(), whole.points.size());
  EXPECT_EQ(watching.questions, whole.questions);
  watching.questions = 0;
  watching.cancel_at = whole.questions / 2;
  EXPECT_EQ(ReasonOf(Fit(&watching).status()), "CANCELLED");
}

// Someone who watches the fit should not wait for the inputs of all models.
TEST_F(FitJournalTest, TheFirstPointComesBeforeTheInputsOfAnyModelAreDone) {
  MemoryJournal journal;
  ASSERT_EQ(*Fit(&journal), expected_);
  ASSERT_FALSE(journal.points.empty());
  EXPECT_EQ(journal.points.front().phase, "fit HMMs");
  EXPECT_EQ(journal.puts_before_points, 0);
}

TEST_F(FitJournalTest, ResumesFromTheLastPartOfEachPut) {
  MemoryJournal whole;
  ASSERT_EQ(*Fit(&whole), expected_);
  for (int k = 1; k <= whole.puts; ++k) {
    MemoryJournal journal;
    journal.fail_put_at = k;
    EXPECT_EQ(ReasonOf(Fit(&journal).status()), "IO") << k;
    ASSERT_EQ(*Fit(&journal), expected_) << k;
  }
  // Nothing is trained a second time.
  MemoryJournal again;
  again.parts = whole.parts;
  EXPECT_EQ(*Fit(&again), expected_);
  EXPECT_EQ(again.puts, 0);
  EXPECT_TRUE(again.points.empty());
}

TEST_F(FitJournalTest, ADamagedPartIsRefused) {
  MemoryJournal whole;
  ASSERT_EQ(*Fit(&whole), expected_);
  for (const auto& [part, bytes] : whole.parts) {
    MemoryJournal journal;
    journal.parts[part] = bytes;
    for (const size_t place :
         {size_t{0}, bytes.size() / 3, bytes.size() - 40, bytes.size() - 1}) {
      std::string& damaged = journal.parts[part];
      damaged = bytes;
      damaged[place] ^= 16;
      const auto result = Fit(&journal);
      EXPECT_EQ(ReasonOf(result.status()), "CHECKPOINT_INVALID") << part;
      EXPECT_EQ(InfoOf(result.status()).metadata().at("part"), part);
    }
    journal.parts[part] = bytes.substr(0, bytes.size() / 2);
    EXPECT_EQ(ReasonOf(Fit(&journal).status()), "CHECKPOINT_INVALID") << part;
    journal.parts[part] = "";
    EXPECT_EQ(ReasonOf(Fit(&journal).status()), "CHECKPOINT_INVALID") << part;
  }
}

TEST_F(FitJournalTest, PartsOfAnotherFitAreRefused) {
  MemoryJournal whole;
  ASSERT_EQ(*Fit(&whole), expected_);
  FitOptions other = SmallOptions();
  other.lstm.training.optimizer.weight_decay *= 2;
  EXPECT_EQ(ReasonOf(Fit(&whole, other).status()), "CHECKPOINT_INVALID");
  MemoryJournal swapped;
  swapped.parts["hmm/SU"] = whole.parts.at("hmm/SM");
  EXPECT_EQ(ReasonOf(Fit(&swapped).status()), "CHECKPOINT_INVALID");
  ContactFrames& frames = contacts_.back().frames;
  ContactFrame last = frames.back();
  last.sample.net_force += 1e-9;
  frames.Set(frames.size() - 1, last);
  EXPECT_EQ(ReasonOf(Fit(&whole).status()), "CHECKPOINT_INVALID");
}

TEST_F(FitJournalTest, ReportsEveryCurve) {
  MemoryJournal journal;
  ASSERT_TRUE(Fit(&journal).ok());
  std::map<std::string, std::vector<LearningPoint>> curves;
  for (const LearningPoint& point : journal.points) {
    curves[point.part].push_back(point);
  }
  // Each fold trains as many networks as the model, and half of the folds train
  // an estimator.
  const std::vector<std::vector<std::string>> networks = {
      {"lstm/0", "lstm/1", "estimator"},
      {"lstm/0", "lstm/1", "estimator"},
      {"lstm/0", "lstm/1"}};
  const std::string prefixes[] = {"", "fold/0/", "fold/1/"};
  for (int p = 0; p < 3; ++p) {
    const std::string& prefix = prefixes[p];
    for (const std::string& network : networks[p]) {
      const auto& curve = curves[prefix + network];
      ASSERT_EQ(curve.size(), 2u) << prefix << network;
      EXPECT_EQ(curve[0].iteration, 1);
      EXPECT_EQ(curve[1].iteration, 2);
      EXPECT_EQ(curve[1].max_iterations, 2);
      EXPECT_EQ(curve[1].phase, "train LSTMs");
      EXPECT_GT(curve[1].loss.value(), 0);
      EXPECT_GE(curve[1].accuracy.value(), 0);
    }
    const auto& hmm = curves[prefix + "hmm/SU/0"];
    ASSERT_EQ(hmm.size(), 3u);
    EXPECT_EQ(hmm[2].iteration, 2);
    EXPECT_GT(hmm[2].log_likelihood.value(), hmm[0].log_likelihood.value());
  }
  EXPECT_FALSE(curves.contains("fold/1/estimator"));
  ASSERT_EQ(curves["fold/1"].size(), 1u);
  EXPECT_GT(curves["fold/1"][0].validation_loss.value(), 0);
  EXPECT_GE(curves["fold/1"][0].validation_accuracy.value(), 0.5);
}

// The softest material is in one fold only.
TEST_F(FitJournalTest, AllFoldsByMaterialTrainAnEstimator) {
  FitOptions options = SmallOptions();
  options.inner_folds = InnerFolds::kMaterials;
  MemoryJournal journal;
  ASSERT_TRUE(Fit(&journal, options).ok());
  std::set<std::string> parts;
  for (const LearningPoint& point : journal.points) parts.insert(point.part);
  EXPECT_TRUE(parts.contains("fold/0/estimator"));
  EXPECT_TRUE(parts.contains("fold/1/estimator"));
  EXPECT_TRUE(parts.contains("fold/2/estimator"));
}

}  // namespace
}  // namespace tactus::internal

// Each rule of skip_rules.h on and off: the answers that it must keep have the
// same bits, and its counter grows.
#include <vector>

#include "core/base/random.h"
#include "core/classify/contact_pipeline.h"
#include "gtest/gtest.h"
#include "tests/support/small_model.h"

namespace tactus::internal {
namespace {

using Numbers = std::vector<double>;

void Append(std::span<const double> values, Numbers& out) {
  out.insert(out.end(), values.begin(), values.end());
}

// The answers that follow from the frame and from the HMMs; the number of
// contacts if there is none.
Numbers HmmAnswers(const ContactPipeline& pipeline) {
  Numbers count = {static_cast<double>(pipeline.contacts().size())};
  if (pipeline.main_contact() == nullptr) return count;
  const ContactReport& r = *pipeline.main_contact();
  const ContactClassifier& c = *r.classifier;
  Numbers out = {count[0],
                 static_cast<double>(r.phase),
                 static_cast<double>(r.id),
                 static_cast<double>(r.onset),
                 static_cast<double>(r.features->touched),
                 r.features->max_force,
                 r.features->net_force,
                 r.features->area_m2,
                 r.features->motion_m,
                 r.features->centroid.row,
                 r.features->centroid.column,
                 static_cast<double>(r.features->region_count),
                 static_cast<double>(c.frames()),
                 static_cast<double>(c.hmm_steps())};
  Append(c.log_likelihood(), out);
  Append(c.hmm_probability(), out);
  return out;
}

// All answers that a stream may send.
Numbers AllAnswers(const ContactPipeline& pipeline) {
  Numbers out = HmmAnswers(pipeline);
  if (pipeline.main_contact() == nullptr) return out;
  const ContactClassifier& c = *pipeline.main_contact()->classifier;
  Append(c.probability(), out);
  Append(c.lstm_probability(), out);
  Append(c.lstm_score(), out);
  out.insert(out.end(),
             {c.stability(), static_cast<double>(c.best_class()), c.unknown()});
  for (const QuestionDecision& decision : c.decisions()) {
    out.insert(out.end(), {static_cast<double>(decision.value),
                           static_cast<double>(decision.frame),
                           static_cast<double>(decision.changed_frame)});
  }
  if (c.decision()) {
    out.push_back(static_cast<double>(c.decision()->class_index));
    out.push_back(static_cast<double>(c.decision()->frame));
  }
  if (c.object()) {
    out.insert(out.end(), {c.object()->log10_stiffness, c.object()->moved_m,
                           c.object()->log10_stiffness_deviation,
                           c.object()->moved_deviation_m});
  }
  return out;
}

struct Trace {
  std::vector<Numbers> all;
  std::vector<Numbers> hmm;
  SkipCounters skipped;
};

class SkippingTest : public ::testing::Test {
 protected:
  SkippingTest() {
    Model model = testing::SmallModel();
    testing::AddLstms(2, model);
    model.inputs.lstm = {{NamedCue("log_spring")}, {NamedCue("row_load_1")}};
    model.inputs.hmm_steps = {2, 5};
    model.inputs.lstm_steps = {3, 10};
    model.estimator = RandomNetwork(2, {5}, 4, Activation::kSoftsign,
                                    GateActivation::kHardSigmoid, 9, 1, 2);
    model.calibration.softest = {4.8, 4.8};
    model_ = *CompiledModel::Create(model);
    options_.release_after_s = 0.05;
    options_.decision.decision_threshold = 0.4;
  }

  // Contacts of all lengths, with frames that repeat, losses of touch, gaps
  // and ends of trials.
  Trace Run(const SkipRules& skip) const {
    ContactPipeline::Options options = options_;
    options.skip = skip;
    auto pipeline = *ContactPipeline::Create(layout_, model_, options);
    Random random(8);
    std::vector<float> taxels(layout_.taxels());
    Trace trace;
    int left = 0;
    bool touched = false;
    for (int t = 0; t < 3000; ++t) {
      if (left-- == 0) {
        touched = !touched;
        left = static_cast<int>(random.Index(touched ? 300 : 12));
        if (random.Index(6) == 0) pipeline->EndTrial();
      }
      if (random.Index(2) == 0) {
        for (int i = 100; i < 106; ++i) {
          taxels[i] = touched ? static_cast<float>(random.Uniform(1, 3)) : 0.0F;
        }
      }
      const uint64_t missing = random.Index(20) == 0 ? random.Index(4) : 0;
      pipeline->Step({.taxels = taxels, .missing_before = missing});
      trace.all.push_back(AllAnswers(*pipeline));
      trace.hmm.push_back(HmmAnswers(*pipeline));
    }
    trace.skipped = pipeline->skipped();
    return trace;
  }

  Trace RunWithout(SkipRule rule) const {
    SkipRules skip;
    skip[rule] = false;
    return Run(skip);
  }

  void ExpectExact(SkipRule rule) const {
    const Trace on = Run({});
    const Trace off = RunWithout(rule);
    EXPECT_GT(on.skipped[rule], 0u);
    EXPECT_EQ(off.skipped[rule], 0u);
    EXPECT_TRUE(on.all == off.all);
    for (int i = 0; i < kSkipRuleCount; ++i) {
      const auto other = static_cast<SkipRule>(i);
      if (other == rule) continue;
      EXPECT_EQ(on.skipped[other], off.skipped[other]) << i;
    }
  }

  std::shared_ptr<const CompiledModel> model_;
  SkinLayout layout_ = *LayoutPreset("cody-forearm");
  ContactPipeline::Options options_;
};

TEST_F(SkippingTest, UntouchedFrames) {
  ExpectExact(SkipRule::kUntouchedFrames);
}

TEST_F(SkippingTest, UnchangedFrames) {
  ExpectExact(SkipRule::kUnchangedFrames);
}

TEST_F(SkippingTest, QuietRows) {
  layout_.light_touch = LightTouch{0.1, 3, 3, 0.001, 0.002};
  ExpectExact(SkipRule::kQuietRows);
}

TEST_F(SkippingTest, UnusedCues) {
  ExpectExact(SkipRule::kUnusedCues);
  // All but the springs and the load profile.
  EXPECT_EQ(Run({}).skipped[SkipRule::kUnusedCues],
            CueCount() - kFeatureCount - kProfileSize - 5);
}

TEST_F(SkippingTest, UnusedLstms) {
  EXPECT_EQ(Run({}).skipped[SkipRule::kUnusedLstms], 0u);
  const Trace with_lstms = Run({});
  options_.decision.scorers = Scorers::kHmms;
  const Trace on = Run({});
  const Trace off = RunWithout(SkipRule::kUnusedLstms);
  EXPECT_GT(on.skipped[SkipRule::kUnusedLstms], 200u);
  EXPECT_EQ(off.skipped[SkipRule::kUnusedLstms], 0u);
  EXPECT_TRUE(on.all == off.all);
  // The scores of the HMMs are the same as beside the LSTMs.
  EXPECT_TRUE(on.hmm == with_lstms.hmm);
  EXPECT_FALSE(on.all == with_lstms.all);
  // Cues that only the LSTMs use are skipped with them.
  EXPECT_EQ(on.skipped[SkipRule::kUnusedCues], CueCount() - kFeatureCount);
}

// Without LSTMs the probabilities are those of the HMMs.
TEST_F(SkippingTest, HmmOnlyAnswersLikeAModelWithoutLstms) {
  options_.decision.scorers = Scorers::kHmms;
  const Trace asked = Run({});
  Model model = testing::SmallModel();
  model.inputs.hmm_steps = {2, 5};
  model_ = *CompiledModel::Create(model);
  options_.decision.scorers = Scorers::kAll;
  EXPECT_TRUE(asked.all == Run({}).all);
}

TEST_F(SkippingTest, UnchangedScores) {
  ExpectExact(SkipRule::kUnchangedScores);
}

TEST_F(SkippingTest, UnchangedScoresOfAHeldCalibration) {
  Model model = model_->model();
  model.calibration.held = true;
  model_ = *CompiledModel::Create(model);
  ExpectExact(SkipRule::kUnchangedScores);
}

// Steps that StepSavings leave out, on 400 random frames of one contact.
class StepSavingsTest : public SkippingTest {
 protected:
  struct Result {
    uint64_t saved = 0;
    std::vector<Numbers> answers;
  };

  Result RunSaving(const StepSavings& savings) const {
    ContactClassifier::Options options;
    options.savings = savings;
    options.looks = false;
    ContactClassifier classifier(model_, options);
    Random random(2);
    Result result;
    for (int t = 0; t < 400; ++t) {
      const double force = random.Uniform(1, 3);
      classifier.Step({{force, 1e-3, 0.01}, force}, 0);
      const auto p = classifier.probability();
      double sum = 0;
      for (const double value : p) sum += value;
      EXPECT_NEAR(sum, 1, 1e-12);
      result.answers.emplace_back(p.begin(), p.end());
    }
    result.saved = classifier.saved_steps();
    return result;
  }

  // Steps that are due in 400 frames.
  uint64_t Due() const {
    StepClock clock(model_->model().inputs.lstm_steps);
    uint64_t due = 0;
    for (uint64_t t = 1; t <= 400; ++t) due += clock.Tick(t);
    return due;
  }
};

TEST_F(StepSavingsTest, NoneUnlessAskedFor) {
  const Result plain = RunSaving({});
  EXPECT_EQ(plain.saved, 0u);
  // No input is the same twice, and no probability is above 1.
  EXPECT_EQ(RunSaving({.settled_probability = 1, .settled_steps = 1}).saved,
            0u);
  EXPECT_TRUE(RunSaving({.unchanged_input = 1e-12}).answers == plain.answers);
}

TEST_F(StepSavingsTest, ASettledAnswerIsCheckedAtEachStride) {
  const uint64_t due = Due();
  // Any answer settles this: three steps in four are left out after the first.
  const Result often =
      RunSaving({.settled_probability = 0.01, .settled_stride = 4});
  EXPECT_GE(often.saved, (due - 4) * 3 / 4 - 3);
  EXPECT_LE(often.saved, due * 3 / 4);
  const Result once =
      RunSaving({.settled_probability = 0.01, .settled_stride = 0});
  EXPECT_EQ(once.saved, due - 1);
}

TEST_F(StepSavingsTest, UnchangedInputsAreLeftOutSomeTimesInARow) {
  const uint64_t due = Due();
  // Whatever the inputs, every fourth step is taken.
  const Result result =
      RunSaving({.unchanged_input = 1e6, .most_unchanged = 3});
  EXPECT_GE(result.saved, (due - 1) * 3 / 4 - 3);
  EXPECT_LE(result.saved, due * 3 / 4);
}

TEST_F(StepSavingsTest, SureHmmsAnswerAlone) {
  const Result hmms_first = RunSaving({.sure_hmm_probability = 0});
  options_.decision.scorers = Scorers::kHmms;
  ContactClassifier hmms(model_, options_.decision);
  Random random(2);
  for (int t = 0; t < 400; ++t) {
    const double force = random.Uniform(1, 3);
    hmms.Step({{force, 1e-3, 0.01}, force}, 0);
    // Before their first step the HMMs are not asked.
    if (t < 10) continue;
    EXPECT_TRUE(std::ranges::equal(hmms.probability(), hmms_first.answers[t]));
  }
  EXPECT_GE(hmms_first.saved, Due() - 1);
}

TEST_F(SkippingTest, AllRulesTogetherAreAsExactWithLightTouch) {
  layout_.light_touch = LightTouch{0.1, 3, 3, 0.001, 0.002};
  SkipRules nothing;
  for (bool& on : nothing) on = false;
  EXPECT_TRUE(Run({}).all == Run(nothing).all);
}

TEST_F(SkippingTest, AllRulesTogetherAreAsExact) {
  SkipRules nothing;
  for (bool& on : nothing) on = false;
  const Trace off = Run(nothing);
  EXPECT_TRUE(Run({}).all == off.all);
  for (int i = 0; i < kSkipRuleCount; ++i) {
    EXPECT_EQ(off.skipped[static_cast<SkipRule>(i)], 0u);
  }
}

}  // namespace
}  // namespace tactus::internal

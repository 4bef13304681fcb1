// The recording session without a terminal, a clock or files; and its journal.
#include "tools/trainctl/skin/trial_recorder.h"

#include <filesystem>
#include <fstream>

#include "core/base/errors.h"
#include "core/contacts/labelled_contact.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"
#include "tools/trainctl/skin/trial_journal.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

SkinInfo RecorderSkin() {
  SkinInfo info;
  info.layout = tactus::internal::testing::FlatLayout(
      "bench", 2, 3, TaxelUnit::kCounts, 5, 10);
  info.scale = 0.5;
  info.sample_rate_hz = 100;
  return info;
}

// An operator and a skin.
class Desk {
 public:
  explicit Desk(const RecorderOptions& options = {.labels = {"HU", "HM", "x"}},
                const SkinInfo& info = RecorderSkin(), bool raw = false)
      : recorder(info, raw ? &info : nullptr, options), raw_(raw) {}

  // Frames with this load on taxel 4.
  void Frames(int count, uint16_t load) {
    for (int i = 0; i < count; ++i) {
      time_ns_ += 10'000'000;
      SkinFrame frame;
      frame.capture_time_ns = time_ns_;
      frame.missing_before = missing;
      missing = 0;
      frame.u16 = {0, 0, 0, 0, load, 0};
      SkinFrame sent = frame;
      sent.u16[0] = 77;
      Take(recorder.Frame(frame, raw_ ? &sent : nullptr));
    }
  }
  // No frames for so long.
  void Silence(double seconds) {
    time_ns_ += static_cast<int64_t>(1e9 * seconds);
  }
  void Key(char key) { Take(recorder.Key(key)); }
  std::vector<std::string> Labels() const {
    std::vector<std::string> labels;
    for (const RecordedTrial& t : trials) labels.push_back(t.trial.label);
    return labels;
  }

  TrialRecorder recorder;
  std::vector<RecordedTrial> trials;
  std::string news;
  bool quit = false;
  uint64_t missing = 0;

 private:
  void Take(const RecorderStep& step) {
    if (step.trial) trials.push_back(*step.trial);
    if (step.undo) trials.pop_back();
    if (!step.news.empty()) news = step.news;
    quit |= step.quit;
  }

  const bool raw_;
  int64_t time_ns_ = 5'000'000'000;
};

TEST(TrialRecorderTest, OnsetAndReleaseCutATrial) {
  Desk desk;
  desk.Key('2');
  desk.Frames(200, 3);
  desk.Frames(150, 60);
  EXPECT_TRUE(desk.recorder.in_contact());
  EXPECT_TRUE(desk.recorder.keeping());
  EXPECT_NEAR(desk.recorder.contact_s(), 1.5, 1e-9);
  desk.Frames(100, 0);
  ASSERT_EQ(desk.trials.size(), 1u);
  const Trial& trial = desk.trials[0].trial;
  EXPECT_EQ(trial.label, "HM");
  EXPECT_EQ(trial.sample_rate_hz, 100);
  // Half a second before the onset, the contact, half a second of release.
  EXPECT_EQ(trial.time.size(), 50u + 150 + 50);
  EXPECT_EQ(trial.time.front(), 0);
  EXPECT_NEAR(trial.time.back(), 2.49, 1e-9);
  EXPECT_EQ(trial.taxels.u16[4], 3);
  EXPECT_EQ(trial.taxels.u16[49 * 6 + 4], 3);
  EXPECT_EQ(trial.taxels.u16[50 * 6 + 4], 60);
  EXPECT_EQ(trial.taxels.u16[199 * 6 + 4], 60);
  EXPECT_EQ(trial.taxels.u16[200 * 6 + 4], 0);
  EXPECT_EQ(trial.taxels.scale, 0.5);
  EXPECT_EQ(trial.skin, RecorderSkin().layout);
  EXPECT_TRUE(Validate(trial, "recorded").ok());
  EXPECT_FALSE(desk.trials[0].raw);
  // As models see it.
  const auto contact = ExtractContact(trial);
  ASSERT_TRUE(contact.ok() && contact->has_value());
  EXPECT_EQ((*contact)->frames.size(), 200u);
  EXPECT_EQ(desk.news, "kept HM, 1.50 s of contact");
}

TEST(TrialRecorderTest, TheLabelStaysUntilAnother) {
  Desk desk;
  desk.Key('1');
  for (int i = 0; i < 3; ++i) {
    desk.Frames(100, 0);
    desk.Frames(30, 60);
  }
  desk.Frames(100, 0);
  desk.Key('x');
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  EXPECT_THAT(desk.Labels(), ElementsAre("HU", "HU", "HU", "x"));
  EXPECT_THAT(desk.recorder.counts(), ElementsAre(3, 0, 1));
}

TEST(TrialRecorderTest, AKeyInAContactIsItsLabel) {
  Desk desk;
  desk.Frames(100, 0);
  desk.Frames(30, 60);
  EXPECT_FALSE(desk.recorder.keeping());
  desk.Key('2');
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  ASSERT_THAT(desk.Labels(), ElementsAre("HM"));
  // From before the onset on.
  EXPECT_EQ(desk.trials[0].trial.time.size(), 50u + 60 + 50);
}

TEST(TrialRecorderTest, WithoutALabelNothingIsKeptAndThatIsSaid) {
  Desk desk;
  desk.Frames(100, 0);
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  EXPECT_TRUE(desk.trials.empty());
  EXPECT_THAT(desk.news, HasSubstr("without a label"));
  EXPECT_FALSE(desk.recorder.label());
}

TEST(TrialRecorderTest, SkipDropsOneContactOrAllUntilALabel) {
  Desk desk;
  desk.Key('1');
  desk.Frames(100, 0);
  desk.Frames(30, 60);
  desk.Key('s');
  EXPECT_FALSE(desk.recorder.keeping());
  desk.Frames(100, 0);
  EXPECT_TRUE(desk.trials.empty());
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  EXPECT_THAT(desk.Labels(), ElementsAre("HU"));
  desk.Key('S');
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  EXPECT_EQ(desk.trials.size(), 1u);
}

TEST(TrialRecorderTest, UndoRemovesTheLastTrial) {
  Desk desk;
  desk.Key('u');
  EXPECT_EQ(desk.news, "there is no trial to remove");
  for (const char key : {'1', '2'}) {
    desk.Key(key);
    desk.Frames(100, 0);
    desk.Frames(30, 60);
    desk.Frames(100, 0);
  }
  desk.Key('u');
  EXPECT_THAT(desk.Labels(), ElementsAre("HU"));
  EXPECT_THAT(desk.recorder.counts(), ElementsAre(1, 0, 0));
  desk.Key('u');
  desk.Key('u');
  EXPECT_TRUE(desk.trials.empty());
}

// 0.2 s between two contacts; they are one. 0.6 s: two, and the second one's
// trial begins after the first one's last touch.
TEST(TrialRecorderTest, ATrialHasNothingOfTheContactBefore) {
  Desk desk({.labels = {"a"}, .pre_roll_s = 1});
  desk.Key('1');
  desk.Frames(200, 0);
  desk.Frames(30, 60);
  desk.Frames(20, 0);
  desk.Frames(30, 60);
  desk.Frames(60, 0);
  desk.Frames(30, 90);
  desk.Frames(60, 0);
  ASSERT_EQ(desk.trials.size(), 2u);
  EXPECT_EQ(desk.trials[0].trial.time.size(), 100u + 80 + 50);
  EXPECT_EQ(desk.trials[1].trial.time.size(), 60u + 30 + 50);
  EXPECT_EQ(desk.trials[1].trial.taxels.u16[4], 0);
}

TEST(TrialRecorderTest, ASilentSkinEndsAContact) {
  Desk desk;
  desk.Key('1');
  desk.Frames(100, 0);
  desk.Frames(30, 60);
  desk.Silence(2);
  desk.Frames(1, 60);
  ASSERT_EQ(desk.trials.size(), 1u);
  EXPECT_EQ(desk.trials[0].trial.time.size(), 50u + 30);
  // The touch after the silence is another contact, without frames before it.
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  ASSERT_EQ(desk.trials.size(), 2u);
  EXPECT_EQ(desk.trials[1].trial.time.size(), 31u + 50);
}

TEST(TrialRecorderTest, LostFramesAreReported) {
  Desk desk;
  desk.Key('1');
  desk.Frames(100, 0);
  desk.Frames(30, 60);
  desk.missing = 3;
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  EXPECT_THAT(desk.news, HasSubstr("3 frames were lost in it"));
}

TEST(TrialRecorderTest, AContactThatNeverEndsIsNotKept) {
  Desk desk({.labels = {"a"}, .longest_s = 2});
  desk.Key('1');
  desk.Frames(100, 0);
  desk.Frames(400, 60);
  EXPECT_THAT(desk.news, HasSubstr("longer than 2 s is not kept"));
  desk.Frames(100, 0);
  EXPECT_TRUE(desk.trials.empty());
  desk.Frames(100, 60);
  desk.Frames(100, 0);
  EXPECT_EQ(desk.trials.size(), 1u);
}

TEST(TrialRecorderTest, ABrushIsNotKept) {
  Desk desk;
  desk.Key('1');
  desk.Frames(100, 0);
  desk.Frames(19, 60);
  desk.Frames(100, 0);
  EXPECT_TRUE(desk.trials.empty());
  EXPECT_EQ(desk.news, "a contact of 0.19 s is too short to be kept");
  desk.Frames(20, 60);
  desk.Frames(100, 0);
  EXPECT_EQ(desk.trials.size(), 1u);
}

TEST(TrialRecorderTest, KeysThatMeanNothingDoNothing) {
  Desk desk;
  // H is the first letter of two labels; there are three.
  for (const char key : {'h', '4', '0', ' ', '\x1b', '\0', '\xff'}) {
    desk.Key(key);
    EXPECT_FALSE(desk.recorder.label()) << key;
  }
  desk.Frames(100, 0);
  desk.Frames(30, 60);
  desk.Key('q');
  EXPECT_TRUE(desk.quit);
  EXPECT_THAT(desk.news, HasSubstr("is not kept"));
  // A command's letter is no label's.
  Desk soft({.labels = {"soft", "unknown"}});
  soft.Key('s');
  EXPECT_FALSE(soft.recorder.label());
  EXPECT_EQ(soft.recorder.KeysText(),
            "1 soft  2 unknown  u undo  s skip  q quit");
}

TEST(TrialRecorderTest, PosesAndRawFramesAreKept) {
  SkinInfo info = RecorderSkin();
  info.with_poses = true;
  Desk desk({.labels = {"a"}, .condition = "slow", .group = "g"}, info, true);
  desk.Key('1');
  desk.Frames(100, 0);
  desk.Frames(30, 60);
  desk.Frames(100, 0);
  ASSERT_EQ(desk.trials.size(), 1u);
  const RecordedTrial& kept = desk.trials[0];
  EXPECT_EQ(kept.trial.poses.size(), kept.trial.time.size());
  EXPECT_EQ(kept.trial.condition, "slow");
  EXPECT_EQ(kept.trial.material, "g");
  ASSERT_TRUE(kept.raw);
  EXPECT_EQ(kept.raw->time, kept.trial.time);
  EXPECT_EQ(kept.raw->taxels.u16[0], 77);
  EXPECT_EQ(kept.trial.taxels.u16[0], 0);
}

class TrialJournalTest : public ::testing::Test {
 protected:
  TrialJournalTest()
      : folder_(fs::path(::testing::TempDir()) / "trial_journal") {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    path_ = folder_ / "mine.h5";
  }
  ~TrialJournalTest() override { fs::remove_all(folder_); }

  RecordedTrial TrialOf(const std::string& label) {
    Desk desk({.labels = {label}}, info_, true);
    desk.Key('1');
    desk.Frames(100, 0);
    desk.Frames(30, 60);
    desk.Frames(100, 0);
    return desk.trials.at(0);
  }
  TrialJournal Open() {
    auto journal = TrialJournal::Open(path_, info_, &info_);
    EXPECT_TRUE(journal.ok()) << journal.status();
    return *std::move(journal);
  }
  static std::vector<std::string> Read(const std::string& path) {
    const auto reader = TrialFileReader::Open(path);
    EXPECT_TRUE(reader.ok()) << reader.status();
    std::vector<std::string> found;
    for (size_t i = 0; reader.ok() && i < reader->size(); ++i) {
      found.push_back(reader->id(i) + " " + reader->Read(i)->label);
    }
    return found;
  }

  const SkinInfo info_ = RecorderSkin();
  const fs::path folder_;
  std::string path_;
};

TEST_F(TrialJournalTest, TrialsGoBehindThoseOfTheFile) {
  for (const char* label : {"a", "b"}) {
    TrialJournal journal = Open();
    ASSERT_TRUE(journal.Add(TrialOf(label)).ok());
    ASSERT_TRUE(journal.Add(TrialOf(label)).ok());
    const auto trials = journal.Finish();
    ASSERT_TRUE(trials.ok()) << trials.status();
    EXPECT_EQ(*trials, label[0] == 'a' ? 2u : 4u);
  }
  const auto expected =
      ElementsAre("000000 a", "000001 a", "000002 b", "000003 b");
  EXPECT_THAT(Read(path_), expected);
  EXPECT_THAT(Read(folder_ / "mine.raw.h5"), expected);
  EXPECT_FALSE(fs::exists(path_ + ".parts"));
  const auto raw = TrialFileReader::Open(folder_ / "mine.raw.h5");
  EXPECT_EQ(raw->Read(0)->taxels.u16[0], 77);
}

// The program was killed: nothing calls Finish.
TEST_F(TrialJournalTest, AnInterruptedSessionGoesOn) {
  {
    TrialJournal journal = Open();
    ASSERT_TRUE(journal.Add(TrialOf("a")).ok());
    ASSERT_TRUE(journal.Add(TrialOf("b")).ok());
  }
  EXPECT_FALSE(fs::exists(path_));
  TrialJournal journal = Open();
  EXPECT_EQ(journal.recovered(), 2u);
  // Those are not undone.
  EXPECT_EQ(ReasonOf(journal.Undo()), "INVALID_CONFIG");
  ASSERT_TRUE(journal.Add(TrialOf("c")).ok());
  ASSERT_TRUE(journal.Add(TrialOf("d")).ok());
  ASSERT_TRUE(journal.Undo().ok());
  ASSERT_TRUE(journal.Finish().ok());
  EXPECT_THAT(Read(path_), ElementsAre("000000 a", "000001 b", "000002 c"));
}

// The program was killed in Finish, when the trial file was there already.
TEST_F(TrialJournalTest, NoTrialIsWrittenTwice) {
  {
    TrialJournal journal = Open();
    ASSERT_TRUE(journal.Add(TrialOf("a")).ok());
  }
  fs::copy(path_ + ".parts", folder_ / "copy");
  ASSERT_TRUE(Open().Finish().ok());
  fs::copy(folder_ / "copy", path_ + ".parts");
  TrialJournal journal = Open();
  EXPECT_EQ(journal.recovered(), 0u);
  EXPECT_EQ(journal.present(), 1u);
  ASSERT_TRUE(journal.Add(TrialOf("b")).ok());
  ASSERT_TRUE(journal.Finish().ok());
  EXPECT_THAT(Read(path_), ElementsAre("000000 a", "000001 b"));
  EXPECT_THAT(Read(folder_ / "mine.raw.h5"),
              ElementsAre("000000 a", "000001 b"));
}

TEST_F(TrialJournalTest, WithoutTrialsThereIsNoFile) {
  EXPECT_EQ(*Open().Finish(), 0u);
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_FALSE(fs::exists(path_ + ".parts"));
}

TEST_F(TrialJournalTest, TrialsOfAnotherSkinAreRefused) {
  for (const bool finish : {false, true}) {
    {
      TrialJournal journal = Open();
      ASSERT_TRUE(journal.Add(TrialOf("a")).ok());
      if (finish) {
        ASSERT_TRUE(journal.Finish().ok());
      }
    }
    SkinInfo other = info_;
    other.layout.contact_threshold = 6;
    EXPECT_THAT(TrialJournal::Open(path_, other, nullptr).status().message(),
                HasSubstr("contact_threshold 5, not 6"));
    other = info_;
    other.sample_rate_hz = 50;
    EXPECT_EQ(ReasonOf(TrialJournal::Open(path_, other, nullptr).status()),
              "INVALID_TRAINING_DATA");
    // A taxel may break.
    other = info_;
    other.layout.mask = {1, 1, 1, 1, 1, 0};
    EXPECT_TRUE(TrialJournal::Open(path_, other, nullptr).ok());
  }
}

TEST_F(TrialJournalTest, ADamagedPartIsNamed) {
  {
    TrialJournal journal = Open();
    ASSERT_TRUE(journal.Add(TrialOf("a")).ok());
  }
  std::ofstream(path_ + ".parts/000000.trial") << "no trial";
  EXPECT_THAT(TrialJournal::Open(path_, info_, nullptr).status().message(),
              HasSubstr("000000.trial"));
}

}  // namespace
}  // namespace tactus::internal::client

// Contacts of one skin became trials of a dataset of another. Nobody learned of
// it before a training refused the whole dataset.
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "spdlog/spdlog.h"
#include "tests/server/support/keeping_server.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/small_trials.h"
#include "tests/tools/trainctl/remote/trainctl_program.h"

namespace tactus::internal {
namespace {

using ::testing::AllOf;
using testing::ConfigRequest;
using ::testing::HasSubstr;
using testing::KeepingServer;
using testing::Packed;

// A trial of three frames on this skin.
Trial TrialOn(const SkinLayout& skin) {
  Trial trial = testing::SmallTrial(0, 3);
  trial.source = "pad_0.csv";
  SetSkin(skin, trial);
  trial.taxels.rows = skin.rows;
  trial.taxels.columns = skin.columns;
  trial.taxels.scale = 1.0 / 1024;
  trial.taxels.u16.assign(size_t{3} * skin.taxels(), 7);
  return trial;
}

class LabelsAcrossSkinsTest : public ::testing::Test {
 protected:
  LabelsAcrossSkinsTest() {
    // The log of the server goes to stdout, as the results of trainctl do.
    spdlog::set_level(spdlog::level::off);
  }

  // Streams a contact on "cody-forearm". Returns its name.
  std::string Touch(const std::string& robot, double rate_hz = 100) {
    v1::ClassifyContactRequest config = ConfigRequest();
    config.mutable_config()->set_sample_rate_hz(rate_hz);
    keeping_.Stream(robot, {1}, config);
    return keeping_.List({}).contacts(0).name();
  }
  void Upload(const std::string& dataset, const Trial& trial) {
    EXPECT_EQ(keeping_.server().Upload(dataset, Packed(trial)),
              dataset + "/versions/1");
  }
  size_t Blobs() {
    return keeping_.server().backend().data().blobs().List()->size();
  }

  const ScratchDir folder_;
  const std::string address_ = "unix:" + (folder_ / "s");
  KeepingServer keeping_{address_};
};

TEST_F(LabelsAcrossSkinsTest, TheSkinOfTheDatasetDecides) {
  const std::string contact = Touch("arm");
  Upload("datasets/pads", TrialOn(*LayoutPreset("icub-6x10")));
  const size_t blobs = Blobs();
  const absl::Status status =
      keeping_.Label("datasets/pads", {{contact, "SM"}}).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_TRIAL");
  EXPECT_THAT(
      std::string(status.message()),
      AllOf(HasSubstr("\"" + contact + " of arm\""),
            HasSubstr("\"cody-forearm\" (16x24 taxels, 100 frames per second)"),
            HasSubstr("\"pad_0.csv\" of datasets/pads"),
            HasSubstr("\"icub-6x10\" (6x10 taxels, 100 frames per second)"),
            HasSubstr("take another dataset")));
  EXPECT_EQ(Blobs(), blobs);
  EXPECT_FALSE(keeping_.List({}).contacts(0).has_given());
}

TEST_F(LabelsAcrossSkinsTest, TrainctlSaysWhatTheServerSays) {
  const std::string contact = Touch("arm");
  Upload("datasets/pads", TrialOn(*LayoutPreset("icub-6x10")));
  const auto label = client::testing::Trainctl(
      {"contacts", "label", "pads", contact + "=SM", "--server=" + address_});
  EXPECT_NE(label.exit, 0);
  EXPECT_THAT(label.err,
              AllOf(HasSubstr(contact + " of arm"), HasSubstr("cody-forearm"),
                    HasSubstr("icub-6x10"), HasSubstr("INVALID_TRIAL")));
}

TEST_F(LabelsAcrossSkinsTest, AThresholdMakesAnotherSkin) {
  const std::string contact = Touch("arm");
  SkinLayout skin = *LayoutPreset("cody-forearm");
  Upload("datasets/same", TrialOn(skin));
  EXPECT_TRUE(keeping_.Label("datasets/same", {{contact, "SM"}}).ok());
  // A taxel may break.
  skin.mask.assign(skin.taxels(), 1);
  skin.mask[5] = 0;
  Upload("datasets/masked", TrialOn(skin));
  EXPECT_TRUE(keeping_.Label("datasets/masked", {{contact, "SM"}}).ok());
  skin.contact_threshold = 0.015;
  Upload("datasets/other", TrialOn(skin));
  EXPECT_THAT(std::string(keeping_.Label("datasets/other", {{contact, "SM"}})
                              .status()
                              .message()),
              HasSubstr("contact_threshold 0.01, not 0.015"));
}

TEST_F(LabelsAcrossSkinsTest, IdealSignalsAreNoSkin) {
  const std::string contact = Touch("arm");
  Upload("datasets/ideal", testing::SmallTrial(0));
  EXPECT_THAT(std::string(keeping_.Label("datasets/ideal", {{contact, "SM"}})
                              .status()
                              .message()),
              HasSubstr("taxels, not ideal signals"));
}

TEST_F(LabelsAcrossSkinsTest, ContactsOfOneRequestAgree) {
  const std::string first = Touch("arm");
  const std::string second = Touch("fast-arm", 102);
  keeping_.CreateDataset("datasets/d");
  const size_t blobs = Blobs();
  const absl::Status status =
      keeping_.Label("datasets/d", {{first, "SM"}, {second, "HU"}}).status();
  EXPECT_EQ(ReasonOf(status), "INVALID_TRIAL");
  EXPECT_THAT(
      std::string(status.message()),
      AllOf(HasSubstr(second + " of fast-arm"), HasSubstr(first + " of arm"),
            HasSubstr("sample_rate_hz 102, not 100")));
  // None of the two is there.
  EXPECT_EQ(Blobs(), blobs);
  const v1::ListContactsResponse list = keeping_.List({});
  for (const v1::LoggedContact& contact : list.contacts()) {
    EXPECT_FALSE(contact.has_given()) << contact.name();
  }
  const auto alone = keeping_.Label("datasets/d", {{second, "HU"}});
  ASSERT_TRUE(alone.ok()) << alone.status();
  EXPECT_EQ(alone->name(), "datasets/d/versions/1");
}

// A damaged trial says nothing of the skin, and keeps nobody from labelling.
TEST_F(LabelsAcrossSkinsTest, ADamagedTrialIsPassedOver) {
  const std::string contact = Touch("arm");
  Upload("datasets/pads", TrialOn(*LayoutPreset("icub-6x10")));
  const auto trials = keeping_.Trials("datasets/pads/versions/1");
  ASSERT_EQ(trials.size(), 1u);
  EXPECT_TRUE(keeping_.server()
                  .backend()
                  .data()
                  .blobs()
                  .Remove(trials[0].sha256())
                  .ok());
  const auto version = keeping_.Label("datasets/pads", {{contact, "SM"}});
  EXPECT_TRUE(version.ok()) << version.status();
}

}  // namespace
}  // namespace tactus::internal

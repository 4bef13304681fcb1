// A corrected label was stored beside the wrong one: the same frames with two
// labels, and no way to take one of them back.
#include <algorithm>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/regress/dataset_server.h"

namespace tactus::internal {
namespace {

using client::Json;
using ::testing::AllOf;
using testing::DatasetServer;
using ::testing::HasSubstr;

class RelabelledRecordingTest : public ::testing::Test {
 protected:
  RelabelledRecordingTest() {
    EXPECT_EQ(server_.Run({"datasets", "create", "r"}).exit, 0);
    EXPECT_EQ(Upload(server_.Write("typo.h5", 0, 6,
                                   [](Trial& trial) {
                                     if (trial.source == "pad_2.csv")
                                       trial.label = "SSU";
                                   }))
                  .exit,
              0);
  }

  client::testing::Outcome Upload(const std::string& path,
                                  const std::string& flag = "") const {
    std::vector<std::string> arguments = {"datasets", "upload", "r",
                                          "--data=" + path};
    if (!flag.empty()) arguments.push_back(flag);
    return server_.Run(arguments);
  }
  Json Labels() const {
    return server_.Run({"datasets", "show", "r", "--json"})
        .json()["versions"]
        .back()["labels"];
  }
  // Under other ids, as another import would have them.
  std::string Fixed() const {
    int number = 100;
    return server_.Write("fixed.h5", 0, 6, [&](Trial& trial) {
      trial.id = std::to_string(number++);
    });
  }

  const DatasetServer server_;
};

TEST_F(RelabelledRecordingTest, IsRefusedWithBothLabels) {
  const auto upload = Upload(Fixed());
  EXPECT_NE(upload.exit, 0);
  EXPECT_THAT(upload.err,
              AllOf(HasSubstr("pad_2.csv"), HasSubstr("\"SU\""),
                    HasSubstr("\"SSU\""), HasSubstr("--replace-labels")));
  EXPECT_EQ(Labels(), Json({{"HU", 3}, {"SSU", 1}, {"SU", 2}}));
}

TEST_F(RelabelledRecordingTest, ReplacesTheLabelIfItIsAskedTo) {
  const auto upload = Upload(Fixed(), "--replace-labels");
  ASSERT_EQ(upload.exit, 0) << upload.err;
  EXPECT_THAT(upload.out, HasSubstr("pad_2.csv (SU, was SSU)"));
  EXPECT_EQ(Labels(), Json({{"HU", 3}, {"SU", 3}}));
  EXPECT_THAT(server_.Run({"datasets", "show", "r"}).out,
              HasSubstr("1 relabelled"));
}

TEST_F(RelabelledRecordingTest, TheSameRecordingIsLeftOutAndCounted) {
  const std::string same =
      server_.Write("same.h5", 4, 8, [](Trial& trial) { trial.id = ""; });
  const auto upload = Upload(same);
  ASSERT_EQ(upload.exit, 0) << upload.err;
  EXPECT_THAT(upload.out, HasSubstr("2 of the trials were there already and "
                                    "were left out: pad_4.csv"));
  EXPECT_EQ(Labels(), Json({{"HU", 4}, {"SSU", 1}, {"SU", 3}}));
}

TEST_F(RelabelledRecordingTest, TwoLabelsInOneFileAreRefused) {
  auto writer = TrialFileWriter::Create(server_.Path("two.h5"), {});
  for (const char* label : {"SU", "HU"}) {
    Trial trial = testing::SmallTrial(40);
    trial.id = label;
    trial.label = label;
    ASSERT_TRUE(writer->Append(trial).ok());
  }
  ASSERT_TRUE(writer->Close().ok());
  const auto upload = Upload(server_.Path("two.h5"), "--replace-labels");
  EXPECT_NE(upload.exit, 0);
  EXPECT_THAT(upload.err, HasSubstr("has the same frames and the label"));
}

TEST_F(RelabelledRecordingTest, RelabelMakesAVersionWithWhoWhenAndWhy) {
  const std::vector<std::string> relabel = {
      "datasets",        "relabel",           "r", "pad_2.csv", "--label=SU",
      "--reason=a typo", "--request-id=fix-1"};
  const auto run = server_.Run(relabel);
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("datasets/r/versions/2"),
                    HasSubstr("1 relabelled by "), HasSubstr(": a typo")));
  EXPECT_EQ(Labels(), Json({{"HU", 3}, {"SU", 3}}));
  // The same request again changes nothing.
  EXPECT_EQ(server_.Run(relabel).out, run.out);
  EXPECT_THAT(server_.Run({"datasets", "show", "r"}).out,
              HasSubstr(": a typo"));
  EXPECT_THAT(server_.Run({"server", "audit"}).out,
              AllOf(HasSubstr("relabel"), HasSubstr("datasets/r/versions/2"),
                    HasSubstr("a typo")));
  // Older versions stay as they were, and both download.
  for (const char* version : {"r@1", "r@2"}) {
    EXPECT_EQ(server_
                  .Run({"datasets", "download", version, "--overwrite",
                        "--out=" + server_.Path("back.h5")})
                  .exit,
              0);
    const auto trials = server_.Read("back.h5");
    EXPECT_EQ(std::ranges::count(trials, std::string("SSU"), &Trial::label),
              version == std::string("r@1") ? 1 : 0);
  }
}

TEST_F(RelabelledRecordingTest, RelabelsAWholeClass) {
  const auto run = server_.Run({"datasets", "relabel", "r", "--from-label=SSU",
                                "--label=SU", "--reason=spelling"});
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_EQ(Labels(), Json({{"HU", 3}, {"SU", 3}}));
}

TEST_F(RelabelledRecordingTest, RemoveMakesAVersionWithoutTheTrial) {
  const auto run = server_.Run({"datasets", "remove", "r", "pad_2.csv",
                                "000000", "--reason=upside down"});
  ASSERT_EQ(run.exit, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("2 removed by "));
  EXPECT_EQ(Labels(), Json({{"HU", 3}, {"SU", 1}}));
  EXPECT_THAT(server_.Run({"server", "audit"}).out, HasSubstr("upside down"));
}

TEST_F(RelabelledRecordingTest, ErrorsNameWhatIsThere) {
  struct Case {
    std::vector<std::string> arguments;
    const char* error;
  };
  const Case cases[] = {
      {{"relabel", "r", "no.csv", "--label=SU", "--reason=x"}, "000000"},
      {{"relabel", "r", "pad_1.csv", "--label=HU", "--reason=x"}, "another"},
      {{"relabel", "r", "--label=HU", "--reason=x"}, "at least one of"},
      {{"relabel", "r", "pad_1.csv", "--label= HU", "--reason=x"}, "blank"},
      {{"relabel", "r", "pad_1.csv", "--label=HU", "--reason= x"}, "reason"},
      {{"remove", "r", "no.csv", "--reason=x"}, "000000"},
      {{"remove", "r", "--reason=x"}, "at least one"},
      {{"remove", "r", "000000", "000001", "000002", "000003", "000004",
        "000005", "--reason=x"},
       "delete"}};
  for (const Case& c : cases) {
    std::vector<std::string> arguments = {"datasets"};
    arguments.insert(arguments.end(), c.arguments.begin(), c.arguments.end());
    const auto run = server_.Run(arguments);
    EXPECT_NE(run.exit, 0) << c.error;
    EXPECT_THAT(run.err, HasSubstr(c.error));
  }
  EXPECT_EQ(Labels(), Json({{"HU", 3}, {"SSU", 1}, {"SU", 2}}));
}

TEST_F(RelabelledRecordingTest, AJobNamesCopiesAndWhatItWasTrainedOn) {
  EXPECT_EQ(Upload(server_.Write("more.h5", 6, 16)).exit, 0);
  ASSERT_EQ(
      server_.Run({"datasets", "remove", "r", "pad_2.csv", "--reason=typo"})
          .exit,
      0);
  ASSERT_EQ(server_
                .Run({"train", "--dataset=r", "--model=m", "--preset=paper",
                      "--networks=0"})
                .exit,
            0);
  const auto own = server_.Run({"evaluate", "--dataset=r", "--model=m@1"});
  ASSERT_EQ(own.exit, 0) << own.err;
  EXPECT_EQ(own.out.rfind("No test: the model was fitted to all 15", 0), 0u)
      << own.out;
  EXPECT_EQ(server_.Run({"evaluate", "--dataset=r", "--model=m@1", "--json"})
                .json()["trained_on_data"],
            true);
  ASSERT_EQ(server_.Run({"datasets", "create", "other"}).exit, 0);
  ASSERT_EQ(server_
                .Run({"datasets", "upload", "other",
                      "--data=" + server_.Write("other.h5", 20, 28)})
                .exit,
            0);
  EXPECT_EQ(
      server_.Run({"evaluate", "--dataset=other", "--model=m@1", "--json"})
          .json()["trained_on_data"],
      false);
}

}  // namespace
}  // namespace tactus::internal

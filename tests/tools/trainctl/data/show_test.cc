// trainctl show, run as from the command line.
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/png_image.h"
#include "tests/tools/trainctl/data/touch_trial.h"
#include "tools/trainctl/verbs.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ShowTest : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(::testing::TempDir()) / "show_test";
    fs::create_directories(folder_);
    trials_ = (folder_ / "trials.h5").string();
    picture_ = (folder_ / "contact.png").string();
    fs::remove(picture_);
    auto writer = TrialFileWriter::Create(trials_, {.overwrite = true});
    ASSERT_TRUE(writer.ok()) << writer.status();
    for (int i = 0; i < 7; ++i) {
      Trial trial = TouchTrial(40, 40);
      trial.id = absl::StrCat("touch-", i);
      ASSERT_TRUE(writer->Append(trial).ok());
    }
    ASSERT_TRUE(writer->Close().ok());
  }

  absl::Status Show(const std::string& arguments) {
    CLI::App app;
    Command command;
    AddShow(app, [&](Command chosen) { command = std::move(chosen); });
    app.parse(
        absl::StrCat("show ", trials_, " --out=", picture_, " ", arguments));
    return command();
  }

  fs::path folder_;
  std::string trials_;
  std::string picture_;
};

TEST_F(ShowTest, DrawsATrialOfTheFile) {
  const absl::Status status = Show("--trial=touch-3");
  ASSERT_TRUE(status.ok()) << status;
  std::ifstream file(picture_, std::ios::binary);
  EXPECT_EQ(DecodePng({std::istreambuf_iterator<char>(file), {}}).width, 1600);
}

TEST_F(ShowTest, AnUnknownTrialIsAnErrorThatNamesSomeIds) {
  const absl::Status status = Show("--trial=000001");
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  const std::string text(status.message());
  EXPECT_THAT(text, HasSubstr("000001"));
  EXPECT_THAT(text, HasSubstr("7 trials"));
  EXPECT_THAT(text, HasSubstr("touch-0, touch-1, touch-2"));
  EXPECT_FALSE(fs::exists(picture_));
}

TEST_F(ShowTest, WithoutGnuplotTheErrorNamesThePackage) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", /*overwrite=*/1);
  const absl::Status status = Show("--trial=touch-3");
  setenv("PATH", path.c_str(), /*overwrite=*/1);
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("gnuplot-nox"));
  EXPECT_FALSE(fs::exists(picture_));
}

TEST_F(ShowTest, ABundleThatIsNotThereIsAnError) {
  EXPECT_EQ(ReasonOf(Show("--trial=touch-3 --model=/nowhere/a.tactus")), "IO");
}

}  // namespace
}  // namespace tactus::internal::client

// `trainctl fit --out` in a folder that is not there failed when the model was
// fitted, and `trainctl evaluate --figures` below a file ended the program when
// the evaluation was done: hours of work were lost.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"
#include "tests/support/trainctl_run.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;
using testing::RunTrainctl;

// The data do not exist either: what is complained of is found first.
TEST(OutputThatCannotBeWrittenTest, IsFoundBeforeTheDataAreRead) {
  const ScratchDir folder;
  const std::string bundle = folder / "missing/model.tactus";
  const auto fit = RunTrainctl("fit --data=none.h5 --out=" + bundle);
  EXPECT_THAT(fit.status.message(), HasSubstr(bundle));

  WriteBytes(folder / "file", "");
  const std::string figures = folder / "file/figures";
  const auto evaluate = RunTrainctl(
      "evaluate --data=none.h5 --protocol=loco --figures=" + figures);
  EXPECT_THAT(evaluate.status.message(), HasSubstr(figures));
}

TEST(OutputThatCannotBeWrittenTest, AFitThatFailsLeavesNoFile) {
  const ScratchDir folder;
  const auto fit =
      RunTrainctl("fit --data=none.h5 --out=" + (folder / "model.tactus"));
  EXPECT_THAT(fit.status.message(), HasSubstr("none.h5"));
  EXPECT_EQ(folder.files(), 0u);
}

}  // namespace
}  // namespace tactus::internal

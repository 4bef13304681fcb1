// A number above the range of double in a skin.json ended the program, by an
// exception of the JSON library that was not caught.
#include "core/base/errors.h"
#include "core/import/skin_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/scratch_dir.h"

namespace tactus::internal {
namespace {

using ::testing::HasSubstr;

absl::Status ReadSkinText(const std::string& text) {
  const ScratchDir folder;
  WriteBytes(folder / "skin.json", text);
  return ReadSkinFile(folder / "skin.json").status();
}

TEST(NumberThatOverflowsTest, IsRefused) {
  for (const char* number : {"1e999", "-1e999", "77777777e77777777777777777"}) {
    const absl::Status status = ReadSkinText(
        absl::StrCat("{\"name\": \"mine\",\n\"rows\": ", number, "}"));
    EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << status;
    EXPECT_THAT(std::string(status.message()), HasSubstr("number"));
  }
}

}  // namespace
}  // namespace tactus::internal

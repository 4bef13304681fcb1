#include "tools/figures/gnuplot.h"

#include <cstdlib>
#include <filesystem>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/png_image.h"
#include "tools/figures/gnuplot_script.h"

namespace tactus::internal::client {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// What the script draws, and an empty image if it fails.
PngImage Drawn(const GnuplotScript& script) {
  const auto png = RunGnuplot(script.text());
  EXPECT_TRUE(png.ok()) << png.status();
  return png.ok() ? DecodePng(*png) : PngImage();
}

// A picture that holds this text and nothing else.
GnuplotScript OnlyText(absl::string_view text, const TextStyle& style) {
  GnuplotScript script(900, 100);
  script.Add("unset border");
  script.Add("unset tics");
  script.Text(text, {40, 50}, style);
  script.Add("plot [0:1] [0:1] NaN");
  return script;
}

TEST(GnuplotTest, APictureHasTheSizeAskedFor) {
  GnuplotScript script(300, 200);
  script.Add("plot x");
  const PngImage image = Drawn(script);
  EXPECT_EQ(image.width, 300);
  EXPECT_EQ(image.height, 200);
}

TEST(GnuplotTest, TheSameScriptGivesTheSameBytes) {
  GnuplotScript script(300, 200);
  script.Add("plot x");
  EXPECT_EQ(*RunGnuplot(script.text()), *RunGnuplot(script.text()));
}

TEST(GnuplotTest, ARejectedScriptIsAnErrorWithItsReason) {
  GnuplotScript script(300, 200);
  script.Add("plot $absent with lines");
  const absl::Status status = RunGnuplot(script.text()).status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("no datablock named $absent"));
}

TEST(GnuplotTest, TheLocaleChangesNeitherPictureNorReason) {
  const char* const before = std::getenv("LC_ALL");
  const std::string old = before == nullptr ? "" : before;
  GnuplotScript good = OnlyText("±30°", {});
  GnuplotScript bad(300, 200);
  bad.Add("plot $absent with lines");
  std::string pictures[2];
  for (int i = 0; i < 2; ++i) {
    setenv("LC_ALL", i == 0 ? "C" : "C.UTF-8", /*overwrite=*/1);
    pictures[i] = *RunGnuplot(good.text());
    EXPECT_THAT(std::string(RunGnuplot(bad.text()).status().message()),
                HasSubstr("no datablock named $absent"));
  }
  if (before == nullptr) {
    unsetenv("LC_ALL");
  } else {
    setenv("LC_ALL", old.c_str(), /*overwrite=*/1);
  }
  EXPECT_EQ(pictures[0], pictures[1]);
}

TEST(GnuplotTest, WithoutGnuplotTheErrorNamesThePackage) {
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nowhere", /*overwrite=*/1);
  const absl::Status status = RunGnuplot("plot x").status();
  setenv("PATH", path.c_str(), /*overwrite=*/1);
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("gnuplot-nox"));
}

TEST(GnuplotTest, APathThatCannotBeWrittenIsAnIoError) {
  GnuplotScript script(300, 200);
  script.Add("plot x");
  const absl::Status status = DrawToFile(script.text(), "/nowhere/a.png");
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("/nowhere/a.png"));
}

// Far more than a pipe holds, in both directions.
TEST(GnuplotTest, LongScriptsAndLargePicturesPass) {
  GnuplotScript script(2000, 1500);
  std::vector<std::vector<double>> rows;
  for (int i = 0; i < 100'000; ++i) rows.push_back({i * 1e-3, i % 97 * 1.});
  script.Data("rows", rows);
  script.Add("plot $rows with dots");
  EXPECT_EQ(Drawn(script).width, 2000);
}

TEST(GnuplotScriptTest, TextCannotLeaveItsQuotes) {
  const fs::path trap = fs::path(::testing::TempDir()) / "gnuplot-trap";
  fs::remove(trap);
  for (const std::string& text :
       {absl::StrCat("`touch ", trap.string(), "`"),
        absl::StrCat("'; system('touch ", trap.string(), "'); '"),
        absl::StrCat("a\n! touch ", trap.string(), "\nb"), std::string("\\"),
        std::string("@macro _{x} ^{y} {/Bold z} %s %d")}) {
    EXPECT_GT(Ink(Drawn(OnlyText(text, {})), 0, 0, 900, 100).pixels, 20)
        << text;
    EXPECT_FALSE(fs::exists(trap)) << text;
  }
}

TEST(GnuplotScriptTest, TextIsAsWideAsReckoned) {
  for (const absl::string_view text :
       {"Accuracy while the touch lasts", "MMMMMMMMMM", "iiiiiiiiii",
        "0123456789 (%) +-/"}) {
    for (const bool bold : {false, true}) {
      const PngImage image = Drawn(OnlyText(text, {.size = 30, .bold = bold}));
      const Spot ink = Ink(image, 0, 0, 900, 100);
      const double width = TextWidth(text, 30, bold);
      EXPECT_NEAR(ink.left, 40, 5) << text;
      EXPECT_LT(ink.right - 40, width + 2) << text << bold;
      EXPECT_GT(ink.right - 40, 0.85 * width) << text << bold;
    }
  }
}

TEST(GnuplotScriptTest, ShortenedTextFits) {
  const std::string text = "a trial with a long name";
  EXPECT_EQ(Shortened(text, 1000, 20), text);
  for (double width = 20; width < TextWidth(text, 20) - 1; width += 10) {
    const std::string shortened = Shortened(text, width, 20);
    EXPECT_LE(TextWidth(shortened, 20), width);
    EXPECT_TRUE(shortened.ends_with("...")) << shortened;
  }
  EXPECT_EQ(Shortened(text, 1, 20), "");
  // Letters of several bytes are not cut apart.
  EXPECT_EQ(Shortened("\u00e4\u00e4\u00e4\u00e4", 60, 20), "\u00e4\u00e4...");
}

}  // namespace
}  // namespace tactus::internal::client

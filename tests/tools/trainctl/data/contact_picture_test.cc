#include "tools/trainctl/data/contact_picture.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/support/png_image.h"
#include "tests/support/text_boxes.h"
#include "tests/tools/trainctl/data/touch_trial.h"
#include "tools/figures/gnuplot.h"
#include "tools/trainctl/data/skin_strip.h"

namespace tactus::internal::client {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

// A contact of `seconds` with posteriors that turn from the first class to the
// second one, decided at `decided_s`.
ContactTrace Trace(double seconds, double decided_s) {
  ContactTrace trace;
  trace.id = "000140";
  trace.label = "HM";
  trace.condition = "k900-v0.012";
  trace.unit = "N";
  trace.class_names = {"HU", "HM", "SU", "SM"};
  trace.probability.resize(4);
  const int frames = static_cast<int>(std::lround(100 * seconds));
  for (int i = 1; i <= frames; ++i) {
    const double first = i < 100 * decided_s ? 0.8 : 0.02;
    trace.time.push_back(0.01 * i);
    trace.features.push_back({1 + std::sin(0.1 * i), 4e-3, 1e-5 * i});
    const double p[] = {first, 0.95 - first, 0.03, 0.02};
    for (int k = 0; k < 4; ++k) trace.probability[k].push_back(p[k]);
    trace.unknown.push_back(0.1);
  }
  trace.decision = {1, decided_s};
  return trace;
}

void AddSkin(ContactTrace& trace) {
  trace.layout = *LayoutPreset("cody-forearm");
  for (size_t i = 0; i < trace.time.size(); ++i) {
    std::vector<float> frame(trace.layout.taxels());
    for (int column = 9; column < 14; ++column) {
      frame[6 * trace.layout.columns + column] = 0.5f;
    }
    trace.frames.push_back(frame);
  }
}

TEST(ContactPictureTest, TextsNeverOverlap) {
  for (const bool with_skin : {false, true}) {
    for (const double seconds : {0.08, 0.5, 5.0, 30.0}) {
      for (const double decided : {0.01, 0.3, 0.9, 1.0}) {
        for (const double released : {0., 0.02, 0.5, 0.99}) {
          ContactTrace trace = Trace(seconds, decided * seconds);
          if (released > 0) trace.release_s = released * seconds;
          if (with_skin) AddSkin(trace);
          EXPECT_EQ(CoveredTexts(ScriptOf(trace)), "")
              << with_skin << ' ' << seconds << ' ' << decided << ' '
              << released;
        }
      }
    }
  }
}

TEST(ContactPictureTest, LongNamesAreShortened) {
  ContactTrace trace = Trace(1, 0.4);
  trace.id = std::string(300, 'x');
  trace.condition = std::string(300, 'y');
  trace.class_names = {std::string(100, 'a'), std::string(100, 'b'),
                       std::string(100, 'c'), "d"};
  AddSkin(trace);
  EXPECT_EQ(CoveredTexts(ScriptOf(trace)), "");
}

// There are colours for seven classes.
TEST(ContactPictureTest, OfManyClassesThoseThatMatterAreDrawn) {
  ContactTrace trace = Trace(1, 0.4);
  const size_t frames = trace.time.size();
  trace.class_names.clear();
  trace.probability.clear();
  for (int k = 0; k < 20; ++k) {
    trace.class_names.push_back(std::string(1, static_cast<char>('a' + k)));
    // 11 to 19 are the most probable ones, and 19 is the answer.
    trace.probability.emplace_back(frames, k < 10 ? 0.01 : 0.002 * k + 0.02);
  }
  trace.probability[3].back() = 0.052;
  trace.label = "b";
  trace.decision = {5, 0.4};
  const GnuplotScript script = ScriptOf(trace);
  EXPECT_EQ(CoveredTexts(script), "");
  for (const Box& box : script.text_boxes()) {
    EXPECT_LE(box.bottom, script.height());
  }
  const std::string& text = script.text();
  for (int k = 0; k < 20; ++k) {
    const bool shown = k == 1 || k == 3 || k == 5 || k >= 16;
    EXPECT_EQ(text.find(absl::StrCat("$posteriors using 1:", k + 2, " ")) !=
                  text.npos,
              shown)
        << k;
  }
  EXPECT_THAT(text, HasSubstr("13 others: at most 0.05"));
  // No colour twice.
  for (int i = 0; i < kMaxSeries; ++i) {
    const std::string curve =
        absl::StrCat("with lines lc rgb '", SeriesColour(i), "' lw 5");
    const size_t first = text.find(curve);
    ASSERT_NE(first, text.npos);
    EXPECT_EQ(text.find(curve, first + 1), text.npos);
  }
}

TEST(ContactPictureTest, ThePictureShowsTheSkinAsItWasTouched) {
  const auto trace = TraceContact(TouchTrial(80, 60), {}, nullptr);
  ASSERT_TRUE(trace.ok()) << trace.status();
  const auto png = RunGnuplot(ScriptOf(*trace).text());
  ASSERT_TRUE(png.ok()) << png.status();
  const PngImage image = DecodePng(*png);
  EXPECT_EQ(image.width, kContactPictureWidth);
  // The patch is at its largest force, 2 N, in the last picture (frame 59) and
  // in those of the frames from 49 on; the colour bar ends with this colour.
  const Rgb brightest = SkinColour(1);
  const uint32_t colour = static_cast<uint32_t>(brightest[0]) << 16 |
                          static_cast<uint32_t>(brightest[1]) << 8 |
                          brightest[2];
  int frames = 0;
  for (const size_t i : PicturedFrames(*trace)) {
    frames += trace->features[i][0] > 1.99;
  }
  ASSERT_GE(frames, 1);
  const std::vector<Spot> patches = Spots(image, colour, 500);
  EXPECT_EQ(patches.size(), static_cast<size_t>(frames));
  // Three of seven taxels of the window each way, inside the white line.
  for (const Spot& patch : patches) {
    EXPECT_NEAR(patch.right - patch.left, 3. / 7 * 130, 8);
  }
  // As many black skins as pictures.
  const Rgb dark = SkinColour(0);
  EXPECT_EQ(Spots(image, dark[2], 2000).size(),
            static_cast<size_t>(kSkinPictures));
}

TEST(ContactPictureTest, WithoutSkinOrModelThesePartsAreMissing) {
  ContactTrace trace = Trace(1, 0.4);
  const std::string with_posteriors = ScriptOf(trace).text();
  EXPECT_THAT(with_posteriors, Not(HasSubstr("$strip")));
  EXPECT_THAT(with_posteriors, HasSubstr("$posteriors"));
  EXPECT_THAT(with_posteriors, HasSubstr("decision: hard-moved (HM)"));
  trace.probability.clear();
  trace.class_names.clear();
  trace.unknown.clear();
  trace.decision.reset();
  const GnuplotScript bare = ScriptOf(trace);
  EXPECT_THAT(bare.text(), Not(HasSubstr("$posteriors")));
  EXPECT_EQ(CoveredTexts(bare), "");
  EXPECT_TRUE(RunGnuplot(bare.text()).ok());
}

TEST(ContactPictureTest, PicturesBeginWithTheOnsetAndEndWithTheRelease) {
  ContactTrace trace = Trace(2, 0.4);
  const auto all = PicturedFrames(trace);
  ASSERT_THAT(all, SizeIs(kSkinPictures));
  EXPECT_EQ(all.front(), 0u);
  EXPECT_EQ(all.back(), 199u);
  EXPECT_TRUE(std::ranges::is_sorted(all));
  trace.release_s = 1.0;
  EXPECT_EQ(PicturedFrames(trace).back(), 99u);
  // A contact shorter than the strip has fewer pictures.
  EXPECT_THAT(PicturedFrames(Trace(0.03, 0.01)), ElementsAre(0, 1, 2));
}

TEST(ContactPictureTest, ClassesOfTheDefaultBundleAreSpeltOut) {
  EXPECT_EQ(DescribeClass("SU"), "soft-unmoved (SU)");
  EXPECT_EQ(DescribeClass("foam"), "foam");
}

}  // namespace
}  // namespace tactus::internal::client

// Skins on serial lines: their bytes, and the driver over a pseudo-terminal.
#include "client/drivers/serial/serial_skin.h"

#include <filesystem>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/drivers/hardware_driver.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/features/contact_tracker.h"
#include "core/files/npy.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/serial/talking_skin.h"
#include "tests/support/shared_data.h"

namespace tactus::internal::client {
namespace {

using testing::AsBytes;
using testing::AsciiFrame;
using testing::BinaryFrame;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using testing::Pty;
using testing::TalkingSkin;
using testing::Values;

Values RandomValues(size_t count, Random& random) {
  Values values(count);
  for (uint16_t& value : values) {
    value = static_cast<uint16_t>(random.Index(256));
  }
  return values;
}

std::vector<Values> AllFrames(SerialFrames& frames) {
  std::vector<Values> all;
  Values values;
  int64_t time_ns = 0;
  while (frames.Next(values, time_ns)) all.push_back(values);
  return all;
}

TEST(SerialSkinTest, ALineHasOneNumberPerTaxel) {
  SerialSkinOptions options;
  options.layout = *LayoutPreset("vitac-12x32");
  options.layout.axes = 3;
  SerialSkin skin("/dev/null", options);
  const absl::Status status = skin.Open();
  EXPECT_EQ(ReasonOf(status), "INVALID_CONFIG");
  EXPECT_THAT(std::string(status.message()),
              HasSubstr("axes of the layout of a skin on a serial line"));
}

TEST(SerialFramesTest, AsciiBeginsAtTheFirstEmptyLine) {
  SerialFrames frames(SerialFormat::kAscii, 2, 3);
  frames.Add(AsBytes("7 8 9\n\n1 2 3\r\n4, 5,6\n\n"), 5);
  EXPECT_THAT(AllFrames(frames), ElementsAre(Values{1, 2, 3, 4, 5, 6}));
  EXPECT_EQ(frames.counters().spoiled, 1u);
}

TEST(SerialFramesTest, AsciiMistakesSpoilTheirFrameOnly) {
  const std::string good = "1 2 3\n4 5 6\n\n";
  for (const char* bad :
       {"1 2\n4 5 6\n\n", "1 2 3 4\n4 5 6\n\n", "1 2 65536\n4 5 6\n\n",
        "1 2 -3\n4 5 6\n\n", "1 2 3\n\n", "1 2 3\n4 5 6\n7 8 9\n\n",
        "1 2 x\n4 5 6\n\n", "1 2 3\n4 5 +6\n\n",
        "11111111111111111111111111111111111111111111111\n4 5 6\n\n"}) {
    SerialFrames frames(SerialFormat::kAscii, 2, 3);
    frames.Add(AsBytes("\n" + good + bad + good), 5);
    EXPECT_EQ(AllFrames(frames).size(), 2u) << bad;
    EXPECT_EQ(frames.counters().spoiled, 1u) << bad;
  }
}

TEST(SerialFramesTest, AnotherShapeIsSeen) {
  SerialFrames frames(SerialFormat::kAscii, 2, 3);
  // The first block may have lost its beginning.
  frames.Add(AsBytes("1 2 3 4\n\n"), 5);
  EXPECT_EQ(frames.seen_shape().rows, 0u);
  std::string wide;
  for (int i = 0; i < 32; ++i) wide += "255 ";
  frames.Add(AsBytes(wide + "\n" + wide + "\n" + wide + "\n\n"), 5);
  EXPECT_EQ(frames.seen_shape().rows, 3u);
  EXPECT_EQ(frames.seen_shape().columns, 32u);
  // Neither lines of two lengths nor words are a shape.
  frames.Add(AsBytes("1 2\n3\n\nx y\nz w\n\n"), 5);
  EXPECT_EQ(frames.seen_shape().rows, 3u);
  EXPECT_TRUE(AllFrames(frames).empty());
}

TEST(SerialFramesTest, BinaryFramesCountOnceTheNextOneBegins) {
  Random random(1);
  SerialFrames frames(SerialFormat::kAa55, 2, 3);
  std::vector<Values> sent;
  for (int i = 0; i < 6; ++i) {
    sent.push_back(RandomValues(6, random));
    frames.Add(AsBytes(BinaryFrame(sent.back())), 100 * i);
    // The first ones wait until the header has come three times.
    Values values;
    int64_t time_ns = 0;
    const int expected = i < 3 ? 0 : i;
    for (int k = i <= 3 ? 0 : i - 1; k < expected; ++k) {
      ASSERT_TRUE(frames.Next(values, time_ns)) << i;
      EXPECT_EQ(values, sent[k]);
      EXPECT_EQ(time_ns, 100 * k);
    }
    EXPECT_FALSE(frames.Next(values, time_ns));
  }
}

// Lost, added and changed bytes: each frame that comes out was sent whole, and
// most of those that were not hit do come out.
TEST(SerialFramesTest, GarbageSpoilsFewFramesAndInventsNone) {
  for (const SerialFormat format :
       {SerialFormat::kAscii, SerialFormat::kAa55}) {
    Random random(4);
    SerialFrames frames(format, 12, 32);
    std::vector<Values> sent;
    size_t hit = 0;
    std::vector<Values> got;
    for (int f = 0; f < 2'000; ++f) {
      const Values values = RandomValues(384, random);
      std::string bytes = format == SerialFormat::kAscii
                              ? AsciiFrame(values, 32)
                              : BinaryFrame(values);
      sent.push_back(values);
      if (random.Index(10) == 0) {
        ++hit;
        const size_t at = random.Index(bytes.size());
        // A byte is lost, or junk comes between: never other values alone, for
        // which there is no checksum.
        if (random.Index(2) == 0 && format == SerialFormat::kAa55) {
          bytes.erase(at, 1 + random.Index(5));
        } else {
          bytes.insert(at, "\x01junk\xAA!");
        }
      }
      for (size_t i = 0; i < bytes.size(); i += 100) {
        frames.Add(AsBytes(bytes.substr(i, 100)), f);
        for (Values& v : AllFrames(frames)) got.push_back(std::move(v));
      }
    }
    size_t next = 0;
    for (const Values& values : got) {
      const auto found = std::find(sent.begin() + static_cast<ptrdiff_t>(next),
                                   sent.end(), values);
      ASSERT_NE(found, sent.end()) << "a frame that was never sent";
      next = static_cast<size_t>(found - sent.begin()) + 1;
    }
    EXPECT_GE(got.size(), sent.size() - 2 * hit - 1);
    EXPECT_GT(frames.counters().spoiled, 0u);
  }
}

TEST(SerialFramesTest, AllTaxelsLikeHeadersAreToldAsSuch) {
  // All taxels read AA 55 AA 55.
  Values values(6);
  for (size_t i = 0; i < 6; ++i) values[i] = i % 2 == 0 ? 0xAA : 0x55;
  SerialFrames frames(SerialFormat::kAa55, 2, 3);
  for (int i = 0; i < 10; ++i) frames.Add(AsBytes(BinaryFrame(values)), i);
  EXPECT_TRUE(AllFrames(frames).empty());
  EXPECT_THAT(frames.Ambiguity(), HasSubstr("AA 55 comes at 4 places"));
}

TEST(SerialFramesTest, FramesThatNobodyTakesAreOverwritten) {
  SerialFrames frames(SerialFormat::kAa55, 1, 1);
  for (int i = 0; i < 200; ++i) frames.Add(AsBytes(BinaryFrame({7})), i);
  EXPECT_EQ(frames.counters().overwritten, 199u - 64u);
  EXPECT_EQ(AllFrames(frames).size(), 64u);
}

SerialSkinOptions SmallSkin(SerialFormat format) {
  SerialSkinOptions options{.format = format, .sample_rate_hz = 100};
  options.layout = *LayoutPreset("vitac-12x32");
  options.layout.rows = 2;
  options.layout.columns = 3;
  return options;
}

TEST(SerialSkinTest, FramesComeThroughATerminal) {
  for (const SerialFormat format :
       {SerialFormat::kAscii, SerialFormat::kAa55}) {
    // With bytes that a terminal that is not raw would change or act on.
    const Values values = {3, 10, 13, 17, 19, 255};
    Pty pty;
    const TalkingSkin talking(
        pty, {format == SerialFormat::kAscii ? AsciiFrame(values, 3)
                                             : BinaryFrame(values)});
    SerialSkin skin(pty.path(), SmallSkin(format));
    HardwareDriver driver(&skin, {});
    const auto info = driver.Configure();
    ASSERT_TRUE(info.ok()) << info.status();
    EXPECT_EQ(info->layout.rows, 2);
    ASSERT_TRUE(driver.Activate().ok());
    SkinFrame frame;
    for (int frames = 0; frames < 20;) {
      const auto result = driver.Read(frame);
      ASSERT_TRUE(result.ok()) << result.status();
      if (*result != ReadResult::kFrame) continue;
      ++frames;
      EXPECT_EQ(frame.u16, values);
    }
  }
}

TEST(SerialSkinTest, AnErrorNamesWhatIsWrong) {
  SerialSkin absent("/dev/no-such-line", SmallSkin(SerialFormat::kAscii));
  EXPECT_EQ(ReasonOf(absent.Open()), "IO");
  SerialSkin file("/dev/null", SmallSkin(SerialFormat::kAscii));
  EXPECT_EQ(ReasonOf(file.Open()), "IO");
  Pty pty;
  SerialSkinOptions options = SmallSkin(SerialFormat::kAscii);
  options.baud = 12'345;
  SerialSkin rate(pty.path(), options);
  EXPECT_EQ(ReasonOf(rate.Open()), "INVALID_CONFIG");
}

TEST(SerialSkinTest, ASilentSkinAndAWrongFormatAreToldApart) {
  Pty pty;
  SerialSkinOptions options = SmallSkin(SerialFormat::kAscii);
  options.first_frame_ns = 200'000'000;
  SerialSkin silent(pty.path(), options);
  HardwareDriver first(&silent, {});
  EXPECT_THAT(std::string(first.Configure().status().message()),
              HasSubstr("the skin sends nothing"));
  const TalkingSkin talking(pty, {BinaryFrame({1, 2, 3, 4, 5, 6})});
  SerialSkin wrong(pty.path(), options);
  HardwareDriver second(&wrong, {});
  EXPECT_THAT(std::string(second.Configure().status().message()),
              HasSubstr("without a whole frame of 2 x 3"));
}

TEST(SerialSkinTest, FramesOfAnotherSizeAreNamed) {
  const Pty pty;
  const TalkingSkin talking(pty, {BinaryFrame({1, 2, 3, 4, 5, 6, 7, 8})});
  SerialSkinOptions options = SmallSkin(SerialFormat::kAa55);
  options.first_frame_ns = 500'000'000;
  SerialSkin skin(pty.path(), options);
  HardwareDriver driver(&skin, {});
  EXPECT_THAT(std::string(driver.Configure().status().message()),
              HasSubstr("without a whole frame of 2 x 3, but frames of 8 "
                        "taxels: give a layout of that size, which may be 1 x "
                        "8, 2 x 4, 4 x 2, 8 x 1"));
}

TEST(SerialSkinTest, ADeviceThatIsPulledOutEndsTheStream) {
  auto pty = std::make_unique<Pty>();
  SerialSkin skin(pty->path(), SmallSkin(SerialFormat::kAa55));
  HardwareDriver driver(&skin, {.give_up_ns = 300'000'000});
  {
    const TalkingSkin talking(*pty, {BinaryFrame({1, 2, 3, 4, 5, 6})});
    ASSERT_TRUE(driver.Configure().ok());
    ASSERT_TRUE(driver.Activate().ok());
  }
  pty->Close();
  SkinFrame frame;
  absl::Status status;
  while (status.ok()) status = driver.Read(frame).status();
  EXPECT_EQ(ReasonOf(status), "IO");
  EXPECT_THAT(std::string(status.message()), HasSubstr("no frame for"));
  EXPECT_FALSE(driver.Statistics().connected);
}

// The features of real presses, as bytes of a serial line and as arrays.
TEST(SerialSkinTest, RealPressesHaveTheSameFeaturesAsTheirArrays) {
  const std::string folder = SharedDataPath("vitac384/trials");
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "needs the recordings vitac384";
  }
  const SkinLayout layout = *LayoutPreset("vitac-12x32");
  int trials = 0;
  int exact = 0;
  size_t contact_frames = 0;
  for (int number = 0; number < 100; ++number) {
    const std::string path = absl::StrFormat("%s/%04d.npy", folder, number);
    if (!std::filesystem::exists(path)) continue;
    const auto array = ReadNpy(path);
    ASSERT_TRUE(array.ok()) << array.status();
    ++trials;
    // The arrays hold twice the counts; interpolated rows have half counts,
    // which no skin sends.
    const size_t values = array->shape[0] * 384;
    Values twice(values);
    bool whole_counts = true;
    for (size_t i = 0; i < values; ++i) {
      const uint16_t value = array->u16[i];
      whole_counts = whole_counts && value % 2 == 0;
      twice[i] = static_cast<uint16_t>(value / 2 * 2);
    }
    exact += whole_counts;
    SerialFrames frames(SerialFormat::kAscii, 12, 32);
    frames.Add(AsBytes("\n"), 0);
    ContactTracker from_bytes(layout, {.sample_rate_hz = 100});
    ContactTracker from_array(layout, {.sample_rate_hz = 100});
    std::vector<float> a(384);
    std::vector<float> b(384);
    for (size_t f = 0; f < array->shape[0]; ++f) {
      Values counts(384);
      for (size_t i = 0; i < 384; ++i) {
        counts[i] = static_cast<uint16_t>(twice[f * 384 + i] / 2);
        b[i] = twice[f * 384 + i];
      }
      frames.Add(AsBytes(AsciiFrame(counts, 32)), static_cast<int64_t>(f));
      Values got;
      int64_t time_ns = 0;
      ASSERT_TRUE(frames.Next(got, time_ns)) << path << " frame " << f;
      for (size_t i = 0; i < 384; ++i) a[i] = 2.0F * got[i];
      const FrameFeatures& x = from_bytes.Step({.taxels = a});
      const FrameFeatures& y = from_array.Step({.taxels = b});
      ASSERT_EQ(x.max_force, y.max_force);
      ASSERT_EQ(x.net_force, y.net_force);
      ASSERT_EQ(x.area_taxels, y.area_taxels);
      ASSERT_EQ(x.motion_m, y.motion_m);
      contact_frames += from_bytes.state() == ContactState::kInContact;
    }
    EXPECT_EQ(frames.counters().spoiled, 0u);
  }
  std::printf("%d trials, %d of them in whole counts, %zu frames in contact\n",
              trials, exact, contact_frames);
  EXPECT_GE(trials, 40);
  EXPECT_GT(contact_frames, 1'000u);
}

}  // namespace
}  // namespace tactus::internal::client

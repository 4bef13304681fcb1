// The bytes of magnetic skins on a serial line.
#include "client/drivers/anyskin/magnet_frames.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/escaping.h"
#include "client/drivers/driver_statistics.h"
#include "core/base/random.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/client/drivers/anyskin/anyskin_bytes.h"
#include "tests/client/drivers/serial/talking_skin.h"

namespace tactus::internal::client {
namespace {

using testing::AnySkinFrame;
using testing::AsBytes;
using testing::Chip;
using testing::Chips;
using testing::FieldOf;
using ::testing::HasSubstr;
using Field = std::vector<float>;

constexpr int64_t kPeriodNs = 2'500'000;

// What Python's struct.pack("<20f", ...) + b"\r\n" makes of kGolden.
constexpr char kGoldenHex[] =
    "0000cc410000c0bf00001040001096c30000d04100000000cdcc4cbe66fe7f45"
    "0000c641000020410000a0c10000f041000040c06f12833acdccccc533cbcc45"
    "0000d841cdcccc3ecdccccbe0ad723c60d0a";
const Chips& Golden() {
  static const auto* const chips = new Chips{{25.5F, -1.5F, 2.25F, -300.125F},
                                             {26.0F, 0.0F, -0.2F, 4095.9F},
                                             {24.75F, 10.0F, -20.0F, 30.0F},
                                             {-3.0F, 1e-3F, -6553.6F, 6553.4F},
                                             {27.0F, 0.4F, -0.4F, -10485.76F}};
  return *chips;
}

// Fields as the chips have them at the settings of the sketch.
Chips AnyChips(Random& random) {
  Chips chips(5);
  const auto reading = [&](float step) {
    return step * (static_cast<float>(random.Index(65'536)) - 32'768);
  };
  for (Chip& chip : chips) {
    chip = {20 + static_cast<float>(random.Index(400)) / 45.2F, reading(0.2F),
            reading(0.2F), reading(0.32266F)};
  }
  return chips;
}

std::vector<Field> AllFields(MagnetFrames& frames) {
  std::vector<Field> all;
  Field field;
  int64_t time_ns = 0;
  while (frames.Next(field, time_ns)) all.push_back(field);
  return all;
}

// Returns false if some of `got` was not sent, or not in this order.
bool IsPartOf(const std::vector<Field>& got, const std::vector<Field>& sent) {
  size_t next = 0;
  for (const Field& field : got) {
    while (next < sent.size() && sent[next] != field) ++next;
    if (next++ == sent.size()) return false;
  }
  return true;
}

TEST(MagnetFramesTest, BytesAreThoseOfTheSketch) {
  const std::string golden = absl::HexStringToBytes(kGoldenHex);
  ASSERT_EQ(golden.size(), 82u);
  EXPECT_EQ(AnySkinFrame(Golden()), golden);
  MagnetFrames frames(5, kPeriodNs);
  EXPECT_EQ(frames.frame_bytes(), 82u);
  frames.Add(AsBytes("\r\n" + golden), 7);
  EXPECT_EQ(AllFields(frames), std::vector<Field>{FieldOf(Golden())});
  EXPECT_EQ(frames.counters().skipped_bytes, 0u);
}

TEST(MagnetFramesTest, AFrameMayComeInAnyTwoPieces) {
  Random random(2);
  const Chips other = AnyChips(random);
  const std::string bytes =
      "\r\n" + AnySkinFrame(Golden()) + AnySkinFrame(other);
  for (size_t at = 0; at <= bytes.size(); ++at) {
    MagnetFrames frames(5, kPeriodNs);
    frames.Add(AsBytes(bytes.substr(0, at)), 1'000'000'000);
    frames.Add(AsBytes(bytes.substr(at)), 1'000'000'001);
    EXPECT_EQ(AllFields(frames),
              (std::vector<Field>{FieldOf(Golden()), FieldOf(other)}))
        << at;
    EXPECT_EQ(frames.counters().spoiled, 0u) << at;
  }
}

// The first frame after a beginning within one is lost, and no other.
TEST(MagnetFramesTest, ReadingMayBeginAnywhere) {
  Random random(3);
  std::vector<Field> sent;
  std::string bytes;
  for (int i = 0; i < 4; ++i) {
    const Chips chips = AnyChips(random);
    sent.push_back(FieldOf(chips));
    bytes += AnySkinFrame(chips);
  }
  for (size_t at = 0; at < 82; ++at) {
    MagnetFrames frames(5, kPeriodNs);
    frames.Add(AsBytes(bytes.substr(at)), 7);
    const auto got = AllFields(frames);
    // With one byte of an end, the end of the next frame is the first.
    EXPECT_EQ(got.size(), at == 81 ? 2u : 3u) << at;
    EXPECT_TRUE(IsPartOf(got, sent)) << at;
  }
}

// A byte is lost, added or changed at each place of the third frame of six.
TEST(MagnetFramesTest, AWrongByteSpoilsItsFrame) {
  enum Damage { kLost, kAdded, kChanged };
  for (const Damage damage : {kLost, kAdded, kChanged}) {
    Random random(4);
    for (size_t at = 0; at < 82; ++at) {
      MagnetFrames frames(5, kPeriodNs);
      std::vector<Field> sent;
      std::string bytes = "\r\n";
      for (int i = 0; i < 6; ++i) {
        const Chips chips = AnyChips(random);
        sent.push_back(FieldOf(chips));
        bytes += AnySkinFrame(chips);
      }
      const size_t hit = 2 + 2 * 82 + at;
      if (damage == kLost) bytes.erase(hit, 1);
      if (damage == kAdded) bytes.insert(hit, "\x55");
      if (damage == kChanged) bytes[hit] = static_cast<char>(~bytes[hit]);
      frames.Add(AsBytes(bytes), 7);
      auto got = AllFields(frames);
      const bool at_end = at >= 80;
      if (damage == kChanged && !at_end) {
        // There is no checksum: the frame may come with the wrong number.
        if (got.size() == 6) got.erase(got.begin() + 2);
        EXPECT_TRUE(IsPartOf(got, sent)) << at;
        EXPECT_EQ(got.size(), 5u) << at;
        continue;
      }
      EXPECT_TRUE(IsPartOf(got, sent)) << damage << " at " << at;
      // The end of a frame is the beginning of the next one.
      EXPECT_EQ(got.size(), at_end && !(damage == kAdded && at == 80) ? 4u : 5u)
          << damage << " at " << at;
      EXPECT_EQ(frames.counters().spoiled, 1u) << damage << " at " << at;
    }
  }
}

// One field stays such that its bytes have "\r\n" among them, at each place.
TEST(MagnetFramesTest, EndsAmongTheNumbersAreNoEnds) {
  Random random(5);
  for (size_t at = 0; at + 1 < 80; ++at) {
    std::vector<Field> sent;
    std::string bytes;
    for (int i = 0; i < 12; ++i) {
      std::string frame = AnySkinFrame(AnyChips(random));
      frame[at] = '\r';
      frame[at + 1] = '\n';
      bytes += frame;
      MagnetFrames alone(5, kPeriodNs);
      alone.Add(AsBytes("\r\n" + frame), 7);
      for (const Field& field : AllFields(alone)) sent.push_back(field);
    }
    // A float with 0A or 0D as its highest byte is too small for a field.
    const bool possible = at % 4 < 2;
    ASSERT_EQ(sent.size(), possible ? 12u : 0u) << at;
    for (const size_t begin : {0, 1, 30, 81}) {
      MagnetFrames frames(5, kPeriodNs);
      frames.Add(AsBytes(bytes.substr(begin)), 7);
      const auto got = AllFields(frames);
      EXPECT_TRUE(IsPartOf(got, sent)) << at << " from " << begin;
      EXPECT_GE(got.size(), possible ? 10u : 0u) << at << " from " << begin;
    }
  }
}

// Lost and added bytes at random: no frame comes that was not sent, and no more
// than two are lost for each that is hit.
TEST(MagnetFramesTest, GarbageSpoilsFewFramesAndInventsNone) {
  Random random(6);
  MagnetFrames frames(5, kPeriodNs);
  std::vector<Field> sent;
  std::vector<Field> got;
  size_t hit = 0;
  for (int f = 0; f < 5'000; ++f) {
    const Chips chips = AnyChips(random);
    sent.push_back(FieldOf(chips));
    std::string bytes = AnySkinFrame(chips);
    if (random.Index(10) == 0) {
      ++hit;
      const size_t at = random.Index(bytes.size());
      if (random.Index(2) == 0) {
        bytes.erase(at, 1 + random.Index(5));
      } else {
        bytes.insert(at, "junk\r\n!");
      }
    }
    for (size_t i = 0; i < bytes.size(); i += 50) {
      frames.Add(AsBytes(bytes.substr(i, 50)), f);
      for (Field& field : AllFields(frames)) got.push_back(std::move(field));
    }
  }
  EXPECT_TRUE(IsPartOf(got, sent));
  EXPECT_GE(got.size() + 2 * hit + 1, sent.size());
  EXPECT_GT(frames.counters().spoiled, hit / 2);
  EXPECT_LE(frames.counters().spoiled, hit);
  EXPECT_EQ(frames.counters().frames, got.size());
}

TEST(MagnetFramesTest, NumbersOfNoChipAreRefusedAndNamed) {
  struct Case {
    float number;
    const char* text;
  };
  const Case cases[] = {
      {std::numeric_limits<float>::quiet_NaN(), "nan uT along y"},
      {std::numeric_limits<float>::infinity(), "inf uT along y"},
      {-2e6F, "-2e+06 uT along y"},
      {1e-20F, "1e-20 uT along y"}};
  for (const Case& c : cases) {
    MagnetFrames frames(5, kPeriodNs);
    Chips bad = Golden();
    bad[3].y = c.number;
    const std::string good = AnySkinFrame(Golden());
    frames.Add(
        AsBytes("\r\n" + good + AnySkinFrame(bad) + AnySkinFrame(bad) + good),
        7);
    EXPECT_EQ(AllFields(frames).size(), 2u);
    EXPECT_EQ(frames.counters().spoiled, 2u);
    EXPECT_EQ(frames.counters().out_of_range, 2u);
    EXPECT_THAT(frames.Refused(), HasSubstr("magnetometer 3 sent a field of "));
    EXPECT_THAT(frames.Refused(), HasSubstr(c.text));
  }
  MagnetFrames hot(5, kPeriodNs);
  Chips chips = Golden();
  chips[0].t = 1.5e3F;
  std::string bytes;
  for (int i = 0; i < 5; ++i) bytes += AnySkinFrame(chips);
  // No frame is good, and Refused() says why.
  hot.Add(AsBytes(bytes), 7);
  EXPECT_TRUE(AllFields(hot).empty());
  EXPECT_THAT(hot.Refused(), HasSubstr("0 sent a temperature of 1500 degrees"));
}

TEST(MagnetFramesTest, AnotherNumberOfMagnetometersIsSeen) {
  Random random(8);
  for (const size_t chips : {1, 2, 4, 10, 64}) {
    MagnetFrames frames(5, kPeriodNs);
    for (int i = 0; i < 12; ++i) {
      Chips all;
      while (all.size() < chips) {
        const Chips more = AnyChips(random);
        all.insert(all.end(), more.begin(), more.end());
      }
      all.resize(chips);
      frames.Add(AsBytes(AnySkinFrame(all)), i);
    }
    EXPECT_TRUE(AllFields(frames).empty()) << chips;
    EXPECT_EQ(frames.seen_magnets(), chips);
  }
}

TEST(MagnetFramesTest, FramesThatNobodyTakesAreOverwritten) {
  MagnetFrames frames(1, kPeriodNs);
  std::string bytes = "\r\n";
  for (int i = 0; i < 200; ++i) {
    bytes += AnySkinFrame({{.x = static_cast<float>(i)}});
  }
  frames.Add(AsBytes(bytes), 1'000'000'000);
  const auto got = AllFields(frames);
  ASSERT_EQ(got.size(), 64u);
  EXPECT_EQ(got.front()[0], 136);
  EXPECT_EQ(got.back()[0], 199);
  EXPECT_EQ(frames.counters().overwritten, 136u);
}

// Frames of 400 Hz, some of them spoiled, on a host that is late now and then:
// what was spoiled is lost, and nothing else.
TEST(MagnetFramesTest, ALateHostLosesNothing) {
  for (const uint64_t seed : {9, 10, 11}) {
    Random random(seed);
    MagnetFrames frames(5, kPeriodNs);
    FrameMeter meter(kPeriodNs);
    uint64_t spoiled = 0;
    uint64_t taken = 0;
    int64_t worst_ns = 0;
    std::string waiting = "\r\n";
    std::vector<int64_t> sent_ns;
    int64_t next_look_ns = 0;
    for (int f = 0; f < 20'000; ++f) {
      // The skin's clock runs 0.5 % slow, and its loop is not quite even.
      const int64_t done_ns = 1'000'000'000 + f * kPeriodNs * 201 / 200 +
                              static_cast<int64_t>(random.Index(100'000));
      while (next_look_ns < done_ns) {
        frames.Add(AsBytes(waiting), next_look_ns);
        waiting.clear();
        Field field;
        int64_t time_ns = 0;
        while (frames.Next(field, time_ns)) {
          meter.Add(time_ns, next_look_ns);
          worst_ns = std::max(worst_ns, std::abs(time_ns - sent_ns[taken++]));
        }
        const bool late = random.Index(200) == 0;
        next_look_ns +=
            late ? static_cast<int64_t>(random.Index(60'000'000)) : 1'000'000;
      }
      std::string bytes = AnySkinFrame(AnyChips(random));
      if (f > 0 && f < 19'900 && random.Index(500) == 0) {
        ++spoiled;
        bytes.erase(random.Index(80), 1);
      } else {
        sent_ns.push_back(done_ns);
      }
      waiting += bytes;
    }
    DriverStatistics statistics;
    meter.Write(statistics);
    EXPECT_GT(taken, 19'500u);
    EXPECT_EQ(statistics.lost, spoiled) << "seed " << seed;
    EXPECT_NEAR(statistics.rate_hz, 400 / 1.005, 2);
    // The host looks once a millisecond.
    EXPECT_LT(worst_ns, kPeriodNs + 1'000'000) << "seed " << seed;
  }
}

}  // namespace
}  // namespace tactus::internal::client

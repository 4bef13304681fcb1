// assemble(disassemble(x)) == x, whatever the bus does to the frames.
#include "client/drivers/icub_skin/scan_assembler.h"

#include <algorithm>
#include <map>

#include "core/base/random.h"
#include "gtest/gtest.h"

namespace tactus::internal::client::icub {
namespace {

constexpr int64_t kPeriodNs = 20'000'000;
constexpr int64_t kFrameNs = 130'000;

const std::vector<SkinBoard> kForearm = {
    {.address = 13}, {.address = 12, .triangles = 0b0011'0011'0100'1011}};

// A skin's values, random where a triangle is.
SkinScan RandomScan(const std::vector<SkinBoard>& boards, Random& random) {
  SkinScan scan;
  scan.raw.assign(boards.size() * kBoardValues, 0);
  scan.out_of_range.assign(boards.size() * kTriangles, 0);
  for (size_t j = 0; j < boards.size(); ++j) {
    for (int t = 0; t < kTriangles; ++t) {
      if ((boards[j].triangles >> t & 1) == 0) continue;
      for (int k = 0; k < kDots; ++k) {
        scan.raw[j * kBoardValues + t * kDots + k] =
            static_cast<uint8_t>(random.Index(256));
      }
      scan.out_of_range[j * kTriangles + t] =
          static_cast<uint16_t>(random.Index(4096));
    }
  }
  return scan;
}

// The frames of board j, the first one at `start_ns`.
std::vector<CanFrame> Frames(const SkinScan& scan, size_t j,
                             const SkinBoard& board, int64_t start_ns) {
  std::vector<CanFrame> frames;
  for (int t = 0; t < kTriangles; ++t) {
    if ((board.triangles >> t & 1) == 0) continue;
    TriangleReading reading;
    std::copy_n(scan.raw.begin() + j * kBoardValues + t * kDots, kDots,
                reading.dots.begin());
    reading.status.out_of_range = scan.out_of_range[j * kTriangles + t];
    const auto [head, tail] = EncodeTriangle(board.address, t, reading);
    for (CanFrame frame : {head, tail}) {
      frame.time_ns = start_ns + kFrameNs * static_cast<int64_t>(frames.size());
      frames.push_back(frame);
    }
  }
  return frames;
}

std::vector<CanFrame> AllFrames(const SkinScan& scan,
                                const std::vector<SkinBoard>& boards,
                                int64_t start_ns) {
  std::vector<CanFrame> frames;
  for (size_t j = 0; j < boards.size(); ++j) {
    const auto more =
        Frames(scan, j, boards[j], start_ns + static_cast<int64_t>(j) * 70'000);
    frames.insert(frames.end(), more.begin(), more.end());
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const CanFrame& a, const CanFrame& b) {
                     return a.time_ns < b.time_ns;
                   });
  return frames;
}

TEST(ScanAssemblerTest, AGoodBusGivesEveryScan) {
  Random random(1);
  ScanAssembler assembler(kForearm, kPeriodNs);
  for (int s = 0; s < 100; ++s) {
    const SkinScan sent = RandomScan(kForearm, random);
    const int64_t start_ns = 1'000 + s * kPeriodNs;
    const auto frames = AllFrames(sent, kForearm, start_ns);
    ASSERT_EQ(frames.size(), 48u);
    SkinScan got;
    for (size_t i = 0; i < frames.size(); ++i) {
      ASSERT_EQ(assembler.Take(frames[i], got), i + 1 == frames.size());
    }
    EXPECT_EQ(got.raw, sent.raw);
    EXPECT_EQ(got.out_of_range, sent.out_of_range);
    EXPECT_EQ(got.start_ns, start_ns);
    EXPECT_EQ(got.end_ns, frames.back().time_ns);
  }
  for (size_t j = 0; j < 2; ++j) {
    EXPECT_EQ(assembler.counters(j).complete, 100u);
    EXPECT_EQ(assembler.counters(j).incomplete, 0u);
    EXPECT_EQ(assembler.counters(j).superseded, 0u);
  }
}

TEST(ScanAssemblerTest, TheOrderWithinAScanDoesNotMatter) {
  Random random(2);
  ScanAssembler assembler(kForearm, kPeriodNs);
  for (int s = 0; s < 200; ++s) {
    const SkinScan sent = RandomScan(kForearm, random);
    auto frames = AllFrames(sent, kForearm, s * kPeriodNs);
    for (size_t i = frames.size(); i > 1; --i) {
      std::swap(frames[i - 1], frames[random.Index(i)]);
    }
    // They arrive in this order, so they are stamped in it.
    for (size_t i = 0; i < frames.size(); ++i) {
      frames[i].time_ns = s * kPeriodNs + kFrameNs * static_cast<int64_t>(i);
    }
    SkinScan got;
    int scans = 0;
    for (const CanFrame& frame : frames) scans += assembler.Take(frame, got);
    ASSERT_EQ(scans, 1);
    EXPECT_EQ(got.raw, sent.raw);
  }
}

// Lost and repeated frames: whatever comes out was sent, in this order, and
// scans of which every frame came do come out.
TEST(ScanAssemblerTest, LossAndRepetitionNeverMixScans) {
  for (const double loss : {0.0005, 0.01, 0.2}) {
    Random random(3);
    ScanAssembler assembler(kForearm, kPeriodNs);
    std::map<std::vector<uint8_t>, int> sent;
    int last = -1;
    int whole = 0;
    int got_count = 0;
    uint64_t repeated = 0;
    for (int s = 0; s < 2'000; ++s) {
      const SkinScan scan = RandomScan(kForearm, random);
      sent[scan.raw] = s;
      bool complete = true;
      for (const CanFrame& frame : AllFrames(scan, kForearm, s * kPeriodNs)) {
        if (random.Uniform() < loss) {
          complete = false;
          continue;
        }
        const int copies = random.Uniform() < 0.01 ? 2 : 1;
        repeated += copies - 1;
        for (int c = 0; c < copies; ++c) {
          SkinScan got;
          if (!assembler.Take(frame, got)) continue;
          ++got_count;
          // A board's scan may be one older than the other board's, if the
          // latter lost its frames.
          if (sent.contains(got.raw)) {
            EXPECT_GT(sent[got.raw], last);
            last = sent[got.raw];
          } else {
            for (size_t j = 0; j < 2; ++j) {
              const auto is_part = [&](const auto& entry) {
                return std::equal(entry.first.begin() + j * kBoardValues,
                                  entry.first.begin() + (j + 1) * kBoardValues,
                                  got.raw.begin() + j * kBoardValues);
              };
              EXPECT_TRUE(std::any_of(sent.begin(), sent.end(), is_part))
                  << "board " << j << " is a mixture, scan " << s;
            }
          }
        }
      }
      whole += complete;
    }
    EXPECT_GE(got_count, whole);
    EXPECT_EQ(assembler.counters(0).repeated + assembler.counters(1).repeated,
              repeated);
  }
}

// An untouched skin sends the same bytes again and again.
TEST(ScanAssemblerTest, EqualScansAreNotTakenForRepetitions) {
  ScanAssembler assembler({{.address = 1, .triangles = 1}}, kPeriodNs);
  SkinScan same;
  same.raw.assign(kBoardValues, 245);
  same.out_of_range.assign(kTriangles, 0);
  SkinScan got;
  int scans = 0;
  for (int s = 0; s < 50; ++s) {
    for (const CanFrame& frame :
         Frames(same, 0, {.address = 1, .triangles = 1}, s * kPeriodNs)) {
      // Each tail is lost in every fifth scan: two equal heads follow.
      if (s % 5 == 4 && frame.data[0] == 0xC0) continue;
      scans += assembler.Take(frame, got);
    }
  }
  EXPECT_EQ(scans, 40);
  EXPECT_EQ(assembler.counters(0).repeated, 0u);
}

// A host that was busy reads many scans at once, with one stamp.
TEST(ScanAssemblerTest, ScansThatAreReadLateAreStillApart) {
  Random random(4);
  ScanAssembler assembler(kForearm, kPeriodNs);
  for (int s = 0; s < 20; ++s) {
    const SkinScan sent = RandomScan(kForearm, random);
    SkinScan got;
    bool complete = false;
    for (CanFrame frame : AllFrames(sent, kForearm, 0)) {
      frame.time_ns = 5;
      complete = assembler.Take(frame, got);
    }
    ASSERT_TRUE(complete);
    EXPECT_EQ(got.raw, sent.raw);
  }
}

TEST(ScanAssemblerTest, ADropInOneScanIsNotFilledFromTheNext) {
  Random random(6);
  const std::vector<SkinBoard> one = {{.address = 4, .triangles = 0b11}};
  ScanAssembler assembler(one, kPeriodNs);
  const SkinScan a = RandomScan(one, random);
  const SkinScan b = RandomScan(one, random);
  const auto first = Frames(a, 0, one[0], 0);
  const auto second = Frames(b, 0, one[0], kPeriodNs);
  SkinScan got;
  // Triangle 1 is lost in the first scan, triangle 0 in the second.
  for (const CanFrame& frame : {first[0], first[1], second[2], second[3]}) {
    EXPECT_FALSE(assembler.Take(frame, got));
  }
  EXPECT_EQ(assembler.counters(0).incomplete, 1u);
  EXPECT_EQ(assembler.counters(0).missing[1], 1u);
}

TEST(ScanAssemblerTest, AFaultyTriangleMakesItsScanNotCount) {
  const std::vector<SkinBoard> one = {{.address = 4, .triangles = 0b11}};
  for (const bool not_connected : {false, true}) {
    ScanAssembler assembler(one, kPeriodNs);
    SkinScan got;
    for (int t = 0; t < 2; ++t) {
      TriangleReading reading;
      if (t == 1) {
        reading.status.no_answer = !not_connected;
        reading.status.not_connected = not_connected;
      }
      const auto [head, tail] = EncodeTriangle(4, t, reading);
      EXPECT_FALSE(assembler.Take(head, got));
      EXPECT_FALSE(assembler.Take(tail, got));
    }
    EXPECT_EQ(assembler.counters(0).faulty[1], 1u);
    EXPECT_EQ(assembler.counters(0).faulty[0], 0u);
    EXPECT_EQ(assembler.counters(0).incomplete, 1u);
    EXPECT_EQ(assembler.counters(0).heard, 0b01);
  }
}

TEST(ScanAssemblerTest, BoardsMayDriftApart) {
  // Board 12 is 1 % slower; whole scans of both come out, and what is left over
  // is counted.
  Random random(8);
  ScanAssembler assembler(kForearm, kPeriodNs);
  std::vector<CanFrame> frames;
  for (int s = 0; s < 500; ++s) {
    const SkinScan scan = RandomScan(kForearm, random);
    for (const auto& frame : Frames(scan, 0, kForearm[0], s * kPeriodNs)) {
      frames.push_back(frame);
    }
    for (const auto& frame :
         Frames(scan, 1, kForearm[1], s * (kPeriodNs + kPeriodNs / 100))) {
      frames.push_back(frame);
    }
  }
  std::stable_sort(frames.begin(), frames.end(),
                   [](const CanFrame& a, const CanFrame& b) {
                     return a.time_ns < b.time_ns;
                   });
  SkinScan got;
  uint64_t scans = 0;
  int64_t last_ns = -1;
  for (const CanFrame& frame : frames) {
    if (!assembler.Take(frame, got)) continue;
    ++scans;
    EXPECT_GT(got.start_ns, last_ns);
    last_ns = got.start_ns;
  }
  EXPECT_EQ(assembler.counters(0).complete, 500u);
  EXPECT_EQ(assembler.counters(1).complete, 500u);
  EXPECT_GE(scans, 494u);
  EXPECT_EQ(assembler.counters(0).incomplete, 0u);
}

TEST(ScanAssemblerTest, StrangersAreIgnoredOrCounted) {
  ScanAssembler assembler({{.address = 4, .triangles = 0b1}}, kPeriodNs);
  SkinScan got;
  // Another board, another class, a wrong size, a triangle that is not there.
  EXPECT_FALSE(assembler.Take(MakeCanFrame(0x450, {0x40, 1}), got));
  EXPECT_FALSE(assembler.Take(MakeCanFrame(0x540, {0x40, 1}), got));
  EXPECT_FALSE(assembler.Take(MakeCanFrame(0x440, {0x40, 1}), got));
  EXPECT_FALSE(
      assembler.Take(MakeCanFrame(0x443, {0x40, 1, 2, 3, 4, 5, 6, 7}), got));
  EXPECT_EQ(assembler.counters(0).malformed, 1u);
  EXPECT_EQ(assembler.counters(0).unexpected, 1u);
}

}  // namespace
}  // namespace tactus::internal::client::icub

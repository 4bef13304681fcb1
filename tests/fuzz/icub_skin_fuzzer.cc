// Any frames, stamps and messages on the bus of an iCub's skin, and any list of
// boards. What comes out must keep its promises.
#include "client/drivers/icub_skin/scan_assembler.h"
#include "client/drivers/icub_skin/skin_patch.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus::internal;
using namespace tactus::internal::client;

CanFrame AnyFrame(FuzzedDataProvider& data) {
  CanFrame frame;
  // Mostly skin data of two boards, so that scans come about.
  const int kind = data.ConsumeIntegralInRange(0, 7);
  frame.id = kind == 0 ? data.ConsumeIntegral<uint32_t>()
                       : 0x4C0U + data.ConsumeIntegralInRange(0, 31);
  frame.size = kind == 1 ? data.ConsumeIntegral<uint8_t>() % 9 : 8;
  for (uint8_t& byte : frame.data) byte = data.ConsumeIntegral<uint8_t>();
  if (kind > 2) frame.data[0] = kind % 2 == 0 ? 0x40 : 0xC0;
  if (kind > 3) frame.data[7] &= 0xF0;
  frame.extended = kind == 2;
  return frame;
}

void Assemble(FuzzedDataProvider& data) {
  const std::vector<icub::SkinBoard> boards = {
      {.address = 13, .triangles = data.ConsumeIntegralInRange<uint16_t>(0, 7)},
      {.address = 12,
       .triangles = data.ConsumeIntegralInRange<uint16_t>(1, 3)}};
  icub::ScanAssembler assembler(boards, 20'000'000);
  icub::SkinScan scan;
  int64_t time_ns = 0;
  while (data.remaining_bytes() > 0) {
    CanFrame frame = AnyFrame(data);
    time_ns += data.ConsumeIntegralInRange(0, 30'000'000);
    frame.time_ns = time_ns;
    icub::ReadReply(frame);
    icub::ReadBoardConfig(frame, 1);
    if (const auto triangles = icub::ReadTriangleConfig(frame, 1)) {
      REQUIRE(triangles->last < icub::kTriangles);
    }
    if (!assembler.Take(frame, scan)) continue;
    REQUIRE(scan.raw.size() == 2 * icub::kBoardValues);
    REQUIRE(scan.start_ns <= scan.end_ns && scan.end_ns <= time_ns);
    for (size_t i = 0; i < scan.raw.size(); ++i) {
      const auto t = i % icub::kBoardValues / icub::kDots;
      const auto bits = boards[i / icub::kBoardValues].triangles;
      REQUIRE((bits >> t & 1) != 0 || scan.raw[i] == 0);
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  FuzzedDataProvider data(bytes, size);
  if (data.ConsumeIntegralInRange(0, 9) == 1) {
    fuzz::RequireReason(
        icub::ParseBoards(data.ConsumeRemainingBytesAsString()).status());
  } else {
    Assemble(data);
  }
  return 0;
}

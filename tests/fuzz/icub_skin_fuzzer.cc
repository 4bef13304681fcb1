// Any frames, stamps and messages on the bus of an iCub's skin, and any
// position file. What comes out must keep its promises.
#include "client/drivers/icub_skin/position_file.h"
#include "client/drivers/icub_skin/scan_assembler.h"
#include "client/drivers/icub_skin/skin_patch.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus;
using namespace tactus::client;

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

void Positions(const std::string& text, bool place) {
  const auto positions = icub::ParsePositions(text);
  fuzz::RequireReason(positions.status());
  if (!positions.ok() || !place) return;
  const auto boards = positions->values.size() / icub::kBoardValues;
  std::vector<icub::SkinBoard> list;
  for (size_t j = 0; j < boards; ++j) {
    list.push_back({.address = static_cast<int>(j + 1)});
  }
  const auto patch = icub::PlacedPatch(list, *positions);
  fuzz::RequireReason(patch.status());
  if (patch.ok()) REQUIRE(icub::Validate(*patch).ok());
}

std::string GoodPositions() {
  std::string text = "name arm\ntaxel2Repr ( 0 0 3 )\n[calibration]\n";
  for (int i = 0; i < icub::kBoardValues; ++i) {
    const bool pad = i % icub::kDots == 6;
    text += pad ? "0 0 0 0 0 0\n"
                : "0." + std::to_string(100 + i % 16) + " 0." +
                      std::to_string(100 + i / 16) + " 0.1 0 0 1\n";
  }
  return text;
}

// One input in 64, by a checksum, so that the fuzzer does not prefer these.
bool IsSelected(const uint8_t* bytes, size_t size) {
  uint32_t hash = 2166136261;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 16777619;
  return hash >> 26 == 0;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  static const auto* const good = new std::vector<std::string>{GoodPositions()};
  if (size == 0) REQUIRE(icub::ParsePositions(good->front()).ok());
  FuzzedDataProvider data(bytes, size);
  switch (data.ConsumeIntegralInRange(0, 9)) {
    case 0:
      // Placing takes a hundred times as long as parsing.
      Positions(fuzz::Damaged(*good, data), IsSelected(bytes, size));
      break;
    case 1:
      fuzz::RequireReason(
          icub::ParseBoards(data.ConsumeRemainingBytesAsString()).status());
      break;
    default:
      Assemble(data);
  }
  return 0;
}

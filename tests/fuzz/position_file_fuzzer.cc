// Any position file of an iCub's skin, and the places of its taxels.
#include "client/drivers/icub_skin/position_file.h"
#include "client/drivers/icub_skin/skin_patch.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus::internal;
using namespace tactus::internal::client;

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
  // Placing takes a hundred times as long as parsing.
  Positions(fuzz::Damaged(*good, data), IsSelected(bytes, size));
  return 0;
}

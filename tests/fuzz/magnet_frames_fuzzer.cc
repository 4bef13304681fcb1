// Any bytes on the serial line of a magnetic skin. Each frame that comes out
// must stand between two ends in what came in, in order, with numbers of a chip
// and rising times.
#include <cmath>
#include <cstring>

#include "client/drivers/anyskin/magnet_frames.h"
#include "tests/fuzz/damaged.h"

namespace {

using namespace tactus::internal;
using namespace tactus::internal::client;

constexpr size_t kMagnets = 2;
constexpr size_t kPayload = 16 * kMagnets;
constexpr int64_t kPeriodNs = 10;

std::string GoodFrames() {
  std::string bytes = "\r\n";
  for (int frame = 0; frame < 6; ++frame) {
    for (size_t i = 0; i < 4 * kMagnets; ++i) {
      const float number =
          0.2F * static_cast<float>(i) - static_cast<float>(frame);
      char text[sizeof number];
      std::memcpy(text, &number, sizeof number);
      bytes.append(text, sizeof text);
    }
    bytes += "\r\n";
  }
  return bytes;
}

// The next place from `from` on at which this frame stands between two ends.
size_t Find(const std::string& bytes, const std::vector<float>& field,
            size_t from) {
  for (size_t at = from; at + kPayload + 4 <= bytes.size(); ++at) {
    if (bytes.compare(at, 2, "\r\n") != 0) continue;
    if (bytes.compare(at + 2 + kPayload, 2, "\r\n") != 0) continue;
    bool equal = true;
    for (size_t i = 0; i < kMagnets; ++i) {
      equal = equal &&
              std::memcmp(&bytes[at + 2 + 16 * i + 4], &field[3 * i], 12) == 0;
    }
    if (equal) return at;
  }
  return bytes.npos;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data_bytes, size_t size) {
  FuzzedDataProvider data(data_bytes, size);
  const size_t piece = data.ConsumeIntegralInRange<size_t>(1, 128);
  const auto step_ns = data.ConsumeIntegralInRange<int64_t>(0, 1'000);
  static const auto* const good = new std::vector<std::string>{GoodFrames()};
  const std::string bytes = fuzz::Damaged(*good, data);
  MagnetFrames frames(kMagnets, kPeriodNs);
  std::vector<float> field;
  int64_t now_ns = 1'000;
  int64_t time_ns = 0;
  int64_t last_ns = INT64_MIN;
  size_t place = 0;
  uint64_t taken = 0;
  for (size_t i = 0; i < bytes.size(); i += piece) {
    const std::string part = bytes.substr(i, piece);
    now_ns += step_ns;
    frames.Add({reinterpret_cast<const uint8_t*>(part.data()), part.size()},
               now_ns);
    while (frames.Next(field, time_ns)) {
      ++taken;
      REQUIRE(field.size() == 3 * kMagnets);
      for (const float number : field) {
        REQUIRE(std::isfinite(number) && std::abs(number) <= 1e6F);
      }
      REQUIRE(time_ns > last_ns);
      last_ns = time_ns;
      place = Find(bytes, field, place);
      REQUIRE(place != bytes.npos);
      place += 2 + kPayload;
    }
  }
  const MagnetCounters& counters = frames.counters();
  REQUIRE(counters.frames == taken + counters.overwritten);
  REQUIRE(counters.out_of_range <= counters.spoiled);
  REQUIRE(counters.skipped_bytes <= bytes.size());
  REQUIRE(taken * (kPayload + 2) + counters.skipped_bytes <= bytes.size());
  REQUIRE(frames.seen_magnets() <= 64);
  // Not more than a text.
  REQUIRE(frames.Refused().size() < 300);
  return 0;
}

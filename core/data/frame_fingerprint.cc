#include "core/data/frame_fingerprint.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/sha256.h"

namespace tactus::internal {
namespace {

// Numbers are hashed as they lie in memory.
static_assert(std::endian::native == std::endian::little);

template <typename Number>
absl::string_view BytesOf(const Number* numbers, size_t count) {
  return {reinterpret_cast<const char*>(numbers), count * sizeof(Number)};
}

template <typename Number>
bool AllZero(const Number* numbers, size_t count) {
  return std::all_of(numbers, numbers + count,
                     [](Number number) { return number == 0; });
}

bool IsBlank(const Trial& trial) {
  const TaxelSeries& taxels = trial.taxels;
  if (!taxels.empty()) {
    return AllZero(taxels.u16.data(), taxels.u16.size()) &&
           AllZero(taxels.i16.data(), taxels.i16.size()) &&
           AllZero(taxels.f32.data(), taxels.f32.size());
  }
  return std::ranges::all_of(trial.signals, [](const FeatureVector& signals) {
    return AllZero(signals.data(), signals.size());
  });
}

}  // namespace

std::string FrameFingerprint(const Trial& trial) {
  if (IsBlank(trial)) return std::string(2 * Sha256::kBytes, '0');
  const TaxelSeries& taxels = trial.taxels;
  const bool skin = !taxels.empty();
  const size_t frames = trial.time.size();
  const std::array<uint64_t, 4> shape = {
      skin, frames, skin ? static_cast<uint64_t>(taxels.rows) : 1,
      skin ? static_cast<uint64_t>(taxels.columns) : kFeatureCount};
  Sha256 hash;
  hash.Add(BytesOf(shape.data(), shape.size()));
  if (taxels.axes > 1) hash.Add(BytesOf(&taxels.axes, 1));
  hash.Add(BytesOf(trial.time.data(), frames));
  if (skin) {
    std::vector<float> frame(taxels.frame_size());
    for (size_t t = 0; t < taxels.frames(); ++t) {
      taxels.Decode(t, frame.data());
      hash.Add(BytesOf(frame.data(), frame.size()));
    }
  } else {
    for (const FeatureVector& signals : trial.signals) {
      hash.Add(BytesOf(signals.data(), signals.size()));
    }
  }
  return absl::BytesToHexString(hash.Finish());
}

bool IdentifiesRecording(absl::string_view fingerprint) {
  return fingerprint.find_first_not_of('0') != absl::string_view::npos;
}

std::string FingerprintOfAll(std::vector<std::string> fingerprints) {
  std::ranges::sort(fingerprints);
  Sha256 hash;
  for (const std::string& fingerprint : fingerprints) {
    hash.Add(absl::StrCat(fingerprint, "\n"));
  }
  return absl::BytesToHexString(hash.Finish());
}

}  // namespace tactus::internal

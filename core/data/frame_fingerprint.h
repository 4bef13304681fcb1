// File: frame_fingerprint.h
//
// The fingerprint of a trial's frames, by which equal recordings are noticed
// whatever they are called.
//
//   const std::string fingerprint = FrameFingerprint(trial);
//   if (IdentifiesRecording(fingerprint) && !seen.insert(fingerprint).second) {
//     Remark(trial);  // the same frames once more
//   }
//
// Thread-safe: free functions without state.
#pragma once

#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "core/data/trial.h"

namespace tactus::internal {

// SHA-256 in 64 hexadecimal digits: of the shape of the frames, their values
// and their times. Values are those of the taxels in their unit, whether they
// are stored as integers or not, or the signals of a trial without taxels. Id,
// source, label, poses, skin and all other texts and numbers have no part in
// it. All zeros if every value is 0: such frames identify no recording.
std::string FrameFingerprint(const Trial& trial);

// False for an empty fingerprint and for one of all zeros.
bool IdentifiesRecording(absl::string_view fingerprint);

// SHA-256 of several fingerprints, in any order.
std::string FingerprintOfAll(std::vector<std::string> fingerprints);

}  // namespace tactus::internal

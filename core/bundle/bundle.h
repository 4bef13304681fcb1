// File: bundle.h
//
// Model bundles as bytes: one file that holds everything needed to classify.
// docs/formats.md describes the format byte by byte.
//
//   auto model = DecodeBundle(bytes);  // a flipped byte anywhere is an error
//   ContactClassifier classifier(*model, {});
//
// Thread-safe: free functions without state. They touch no files.
#pragma once

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/compiled_model.h"

namespace tactus::internal {

// Bundles whose networks have hidden layers have version 2, and bundles of
// learners without HMMs or with answers that hold have version 3, because
// readers of earlier versions would leave these out. So would they leave out
// components and auxiliary taxels (core/taxels/components.h), which version 4
// has. All others have version 1. All are read.
inline constexpr uint32_t kBundleFormatVersion = 1;
inline constexpr uint32_t kBundleFormatVersionHidden = 2;
inline constexpr uint32_t kBundleFormatVersionRecordings = 3;
inline constexpr uint32_t kBundleFormatVersionComponents = 4;

// The format version of this model's bundle.
uint32_t BundleFormatVersion(const Model& model);

// The bundle of a valid model; INVALID_MODEL for any other. The same model
// gives the same bytes.
absl::StatusOr<std::string> EncodeBundle(const Model& model);

// The model of a bundle, compiled and ready to serve; RunWarmUp is left to the
// caller. BUNDLE_CORRUPT if the envelope or the checksum is wrong,
// BUNDLE_VERSION if the format version is unknown, INVALID_MODEL if the
// contents are inconsistent.
absl::StatusOr<std::shared_ptr<const CompiledModel>> DecodeBundle(
    absl::string_view bytes);

// BUNDLE_CORRUPT if the bundle has fields that this program does not know; for
// bundles of others that are to be kept, because DecodeBundle leaves such
// fields out.
absl::Status CheckBundleFields(absl::string_view bytes);

// The checksum at the end of a bundle, 64 hexadecimal digits; empty if
// `bytes` is too short to be one.
std::string BundleSha256(absl::string_view bytes);

// What that checksum covers: all bytes before it.
absl::string_view BundleBody(absl::string_view bytes);

}  // namespace tactus::internal

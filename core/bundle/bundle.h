// File: bundle.h
//
// Model bundles as bytes: one file that holds everything needed to classify.
// docs/formats.md tells the format byte by byte.
//
//   auto model = DecodeBundle(bytes);      // a byte flipped anywhere: error
//   auto compiled = CompiledModel::Create(*std::move(model));
//
// Thread-safe: free functions without state. No files are touched here.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/classify/model.h"

namespace tactus {

inline constexpr uint32_t kBundleFormatVersion = 1;

// The bundle of a valid model; INVALID_MODEL for any other. The same model
// gives the same bytes.
absl::StatusOr<std::string> EncodeBundle(const Model& model);

// BUNDLE_CORRUPT if the envelope or the checksum is wrong, BUNDLE_VERSION if
// the format is another, INVALID_MODEL if the contents are inconsistent.
absl::StatusOr<Model> DecodeBundle(absl::string_view bytes);

// The checksum at the end of a bundle, 64 hexadecimal digits; empty if
// `bytes` is too short to be one.
std::string BundleSha256(absl::string_view bytes);

}  // namespace tactus

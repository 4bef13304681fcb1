// File: sha256.h
//
// SHA-256 of bytes that arrive in pieces.
//
//   Sha256 hash;
//   hash.Add(header);
//   hash.Add(payload);
//   const std::string digest = hash.Finish();  // 32 bytes
//
// Owns its state. Not thread-safe.
#pragma once

#include <memory>
#include <string>

#include "absl/strings/string_view.h"

namespace tactus::internal {

class Sha256 {
 public:
  static constexpr size_t kBytes = 32;

  Sha256();
  Sha256(Sha256&&) noexcept;
  ~Sha256();

  void Add(absl::string_view bytes);
  // Returns the digest. Nothing may be added afterwards.
  std::string Finish();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

// The digest of `bytes`.
std::string Sha256Of(absl::string_view bytes);

// The same in 64 hexadecimal digits, lower case.
std::string Sha256Hex(absl::string_view bytes);

// True if `text` is 64 hexadecimal digits, lower case.
bool IsSha256Hex(absl::string_view text);

}  // namespace tactus::internal

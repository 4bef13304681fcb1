// File: sealed_bundle.h
//
// A bundle file around any payload, with the right length and checksum, as
// somebody would make one who wants to get past them.
//
//   DecodeBundle(SealedBundle(message.SerializeAsString()));
//
// A free function without state.
#pragma once

#include <openssl/evp.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "core/bundle/bundle.h"

namespace tactus::internal::testing {

inline std::string SealedBundle(const std::string& payload) {
  const uint32_t version = kBundleFormatVersion;
  const uint64_t length = payload.size();
  std::string bytes = "TACTUSMB";
  bytes.append(reinterpret_cast<const char*>(&version), sizeof version);
  bytes.append(reinterpret_cast<const char*>(&length), sizeof length);
  bytes += payload;
  unsigned char digest[32];
  EVP_Digest(bytes.data(), bytes.size(), digest, nullptr, EVP_sha256(),
             nullptr);
  bytes.append(reinterpret_cast<const char*>(digest), sizeof digest);
  return bytes;
}

}  // namespace tactus::internal::testing

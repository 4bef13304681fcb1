// File: token_file.h
//
// The bearer token of a program's user, from a file that holds nothing else.
//
//   TACTUS_ASSIGN_OR_RETURN(const std::string token,
//                           ReadToken("arm-7.token", "arm.lab:50051", true));
//
// Thread-safe: a free function without state.
#pragma once

#include <algorithm>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/address.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"

namespace tactus::internal::client {

// The token in the file, for a server at `address`. IO if the file cannot be
// read or holds no token; INVALID_CONFIG if the token would leave this host
// without TLS.
inline absl::StatusOr<std::string> ReadToken(const std::string& path,
                                             const std::string& address,
                                             bool tls) {
  constexpr size_t kMaxFileBytes = 4'096;
  if (!tls && !StaysOnThisHost(address)) {
    return InvalidConfig(absl::StrCat("the connection to ", address), "plain",
                         "TLS, because a token must not leave this host "
                         "unencrypted");
  }
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, kMaxFileBytes));
  const absl::string_view token = absl::StripAsciiWhitespace(text);
  if (token.empty() || !std::all_of(token.begin(), token.end(), [](char c) {
        return absl::ascii_isgraph(c);
      })) {
    return IoError(path, "holds no token, which is one word of ASCII");
  }
  return std::string(token);
}

}  // namespace tactus::internal::client

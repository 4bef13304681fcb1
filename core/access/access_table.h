// File: access_table.h
//
// AccessTable: which token and which client certificate has which role, from
// the text of a tokens file:
//
//   # Lines that begin with # and empty lines mean nothing.
//   arm-7 robot
//   9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08
//   certificate lab-pc.example trainer
//
// A line for a token holds the token's name, its role and the SHA-256 of the
// token's text in hexadecimal, so that the file does not reveal the token. A
// line for a certificate holds the common name of its subject. Names tell
// callers apart in logs and in the audit log: 1 to 64 letters, digits and
// ". _ - @".
//
//   TACTUS_ASSIGN_OR_RETURN(const AccessTable table, AccessTable::Parse(text));
//   const AccessTable::Entry* entry = table.FindToken(token);
//   if (entry != nullptr && entry->role >= Role::kTrainer) Use(entry->name);
//
// Immutable; thread-safe.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/access/role.h"

namespace tactus::internal {

class AccessTable {
 public:
  static constexpr size_t kMaxFileBytes = 1024 * 1024;
  // Tokens and certificates together. A call compares its token with all.
  static constexpr size_t kMaxEntries = 1'000;
  // As long as a common name may be (X.520).
  static constexpr size_t kMaxNameBytes = 64;

  struct Entry {
    std::string name;
    Role role = Role::kRobot;
  };
  struct Token {
    Entry entry;
    // SHA-256 of the token's text, 32 bytes.
    std::string digest;
  };

  // INVALID_CONFIG with the number of the first line that is wrong. A text
  // without an entry is wrong too: it would refuse every call.
  static absl::StatusOr<AccessTable> Parse(absl::string_view text);

  // Null if no entry has this token. Takes equally long whichever entry has it.
  const Entry* FindToken(absl::string_view token) const;
  // Null if no entry has a certificate with this common name.
  const Entry* FindCertificate(absl::string_view common_name) const;

  // In the order of their lines.
  const std::vector<Token>& tokens() const { return tokens_; }
  // By name.
  const std::map<std::string, Entry, std::less<>>& certificates() const {
    return certificates_;
  }

 private:
  absl::Status AddLine(absl::string_view line);
  absl::Status AddToken(absl::string_view name, Role role,
                        absl::string_view hex);

  std::vector<Token> tokens_;
  std::map<std::string, Entry, std::less<>> certificates_;
};

// The line of a tokens file for `token`, with its end. INVALID_CONFIG if the
// name is wrong.
absl::StatusOr<std::string> TokenLine(absl::string_view name, Role role,
                                      absl::string_view token);

// `text`, that of a tokens file, without the lines of the token and of the
// certificate `name`. All other lines stay as they are.
std::string WithoutEntry(absl::string_view text, absl::string_view name);

}  // namespace tactus::internal

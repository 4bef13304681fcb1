#include "core/access/access_table.h"

#include <openssl/crypto.h>

#include <algorithm>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/sha256.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

// The first word of a line for a certificate.
constexpr absl::string_view kCertificate = "certificate";

bool MayBeInAName(char c) {
  return absl::ascii_isalnum(c) || c == '.' || c == '_' || c == '-' || c == '@';
}

absl::Status CheckName(absl::string_view name) {
  if (name.empty() || name.size() > AccessTable::kMaxNameBytes ||
      !std::all_of(name.begin(), name.end(), MayBeInAName)) {
    return InvalidConfig("the name", Quoted(name),
                         absl::StrCat("1 to ", AccessTable::kMaxNameBytes,
                                      " letters, digits and . _ - @"));
  }
  return absl::OkStatus();
}

absl::Status CheckTokenName(absl::string_view name) {
  if (name == kCertificate) {
    return InvalidConfig("the name of a token", Quoted(name),
                         "another one: this word begins the line of a "
                         "certificate, \"certificate NAME ROLE\"");
  }
  return CheckName(name);
}

std::vector<absl::string_view> WordsOf(absl::string_view line) {
  return absl::StrSplit(line, absl::ByAnyChar(" \t\r"), absl::SkipEmpty());
}

}  // namespace

absl::StatusOr<AccessTable> AccessTable::Parse(absl::string_view text) {
  if (text.size() > kMaxFileBytes) {
    return InvalidConfig("the size", absl::StrCat(text.size(), " bytes"),
                         absl::StrCat("at most ", kMaxFileBytes));
  }
  AccessTable table;
  int number = 0;
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    ++number;
    line = absl::StripAsciiWhitespace(line);
    if (line.empty() || line[0] == '#') continue;
    TACTUS_RETURN_IF_ERROR(
        Annotate(table.AddLine(line), absl::StrCat("line ", number)));
  }
  if (table.tokens_.empty() && table.certificates_.empty()) {
    return InvalidConfig("the number of entries", 0,
                         "at least 1; trainctl tokens create makes one");
  }
  return table;
}

absl::Status AccessTable::AddLine(absl::string_view line) {
  if (tokens_.size() + certificates_.size() == kMaxEntries) {
    return InvalidConfig("the number of entries", kMaxEntries + 1,
                         absl::StrCat("at most ", kMaxEntries));
  }
  const std::vector<absl::string_view> words = WordsOf(line);
  const bool certificate = words[0] == kCertificate;
  if (words.size() != 3) {
    return InvalidConfig(
        "the number of words", words.size(),
        certificate ? "3: certificate NAME ROLE" : "3: NAME ROLE SHA-256");
  }
  const absl::string_view name = words[certificate ? 1 : 0];
  TACTUS_RETURN_IF_ERROR(CheckName(name));
  TACTUS_ASSIGN_OR_RETURN(const Role role,
                          ParseRole(words[certificate ? 2 : 1]));
  if (!certificate) return AddToken(name, role, words[2]);
  if (!certificates_
           .try_emplace(std::string(name), Entry{std::string(name), role})
           .second) {
    return InvalidConfig("the certificate", Quoted(name),
                         "on one line only; an earlier line has it too");
  }
  return absl::OkStatus();
}

absl::Status AccessTable::AddToken(absl::string_view name, Role role,
                                   absl::string_view hex) {
  // Never shown: someone may have put the token there.
  if (!IsSha256Hex(hex)) {
    return InvalidConfig(
        "the SHA-256", absl::StrCat("a word of ", hex.size(), " bytes"),
        "64 hexadecimal digits, lower case, as trainctl tokens create writes "
        "them");
  }
  Token token = {{std::string(name), role}, absl::HexStringToBytes(hex)};
  for (const Token& other : tokens_) {
    if (other.entry.name == name) {
      return InvalidConfig("the name", Quoted(name),
                           "on one line only; an earlier line has it too");
    }
    if (other.digest == token.digest) {
      return InvalidConfig("the SHA-256",
                           absl::StrCat("that of ", other.entry.name),
                           "different in each line");
    }
  }
  tokens_.push_back(std::move(token));
  return absl::OkStatus();
}

const AccessTable::Entry* AccessTable::FindToken(
    absl::string_view token) const {
  const std::string digest = Sha256Of(token);
  const Entry* found = nullptr;
  for (const Token& candidate : tokens_) {
    // Compares all bytes, and goes on after a match.
    const bool equal = CRYPTO_memcmp(candidate.digest.data(), digest.data(),
                                     Sha256::kBytes) == 0;
    found = equal ? &candidate.entry : found;
  }
  return found;
}

const AccessTable::Entry* AccessTable::FindCertificate(
    absl::string_view common_name) const {
  const auto found = certificates_.find(common_name);
  return found == certificates_.end() ? nullptr : &found->second;
}

absl::StatusOr<std::string> TokenLine(absl::string_view name, Role role,
                                      absl::string_view token) {
  TACTUS_RETURN_IF_ERROR(CheckTokenName(name));
  return absl::StrCat(name, " ", RoleName(role), " ", Sha256Hex(token), "\n");
}

std::string WithoutEntry(absl::string_view text, absl::string_view name) {
  std::string rest;
  while (!text.empty()) {
    const size_t end = text.find('\n');
    const absl::string_view line =
        text.substr(0, end == absl::string_view::npos ? end : end + 1);
    text.remove_prefix(line.size());
    const auto words = WordsOf(absl::StripAsciiWhitespace(line));
    const size_t at = !words.empty() && words[0] == kCertificate ? 1 : 0;
    const bool of_name =
        words.size() > at && words[0][0] != '#' && words[at] == name;
    if (!of_name) absl::StrAppend(&rest, line);
  }
  return rest;
}

}  // namespace tactus::internal

#include "core/base/text.h"

#include <cstdint>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "core/base/limits.h"

namespace tactus::internal {
namespace {

struct Character {
  // 0 if the bytes are not UTF-8.
  size_t bytes = 0;
  uint32_t code = 0;
};

// Decodes the first character of `text`, which is not empty.
Character FirstCharacter(absl::string_view text) {
  const auto byte = [text](size_t i) {
    return static_cast<uint32_t>(static_cast<unsigned char>(text[i]));
  };
  const uint32_t first = byte(0);
  if (first < 0x80) return {1, first};
  const size_t bytes = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < bytes) return {};
  uint32_t code = first & (0x7FU >> bytes);
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3FU);
  }
  constexpr uint32_t kSmallest[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
  if (code < kSmallest[bytes] || code > 0x10FFFF || surrogate) return {};
  return {bytes, code};
}

bool IsControl(uint32_t code) {
  return code < 0x20 || (code >= 0x7F && code < 0xA0);
}

}  // namespace

bool IsUtf8(absl::string_view text) {
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    if (character.bytes == 0) return false;
    text.remove_prefix(character.bytes);
  }
  return true;
}

std::string TextFault(absl::string_view text, size_t max_bytes) {
  if (text.size() > max_bytes) {
    return absl::StrCat("has ", text.size(), " bytes; it must have at most ",
                        max_bytes);
  }
  for (size_t at = 0; at < text.size();) {
    const Character character = FirstCharacter(text.substr(at));
    if (character.bytes == 0) {
      return absl::StrCat("is not UTF-8 at byte ", at);
    }
    if (IsControl(character.code)) {
      return absl::StrCat("holds a control character at byte ", at);
    }
    at += character.bytes;
  }
  return "";
}

std::string Printable(absl::string_view text) {
  std::string line;
  line.reserve(text.size());
  while (!text.empty()) {
    const Character character = FirstCharacter(text);
    if (character.bytes == 0 || IsControl(character.code)) {
      line += '?';
      text.remove_prefix(character.bytes == 0 ? 1 : character.bytes);
      continue;
    }
    line.append(text.data(), character.bytes);
    text.remove_prefix(character.bytes);
  }
  return line;
}

std::string Quoted(absl::string_view text) {
  const absl::string_view shown = text.substr(0, limits::kMaxNameBytes);
  return absl::StrCat("\"", absl::CHexEscape(shown), "\"",
                      shown.size() < text.size() ? "..." : "");
}

}  // namespace tactus::internal

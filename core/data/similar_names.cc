#include "core/data/similar_names.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

constexpr size_t kMostRemarks = 10;
// The letters of U+00C0 to U+017F in lower case without their accents.
constexpr absl::string_view kBaseLetters =
    "aaaaaa\?ceeeeiiii\?nooooo\?ouuuuy\?\?aaaaaa\?ceeeeiiii\?nooooo\?ouuuuy\?y"
    "aaaaaaccccccccddddeeeeeeeeeegggggggghhhhiiiiiiiiii\?\?jjkk\?llllll\?"
    "\?llnnnnnn\?\?\?oooooo\?\?rrrrrrssssssssttttttuuuuuuuuuuuuwwyyyzzzzzz\?";

// One character of UTF-8 off the front of `text`, which is not empty.
char32_t TakeCharacter(absl::string_view* text) {
  const auto byte = [&](size_t i) {
    return static_cast<char32_t>(static_cast<unsigned char>((*text)[i]));
  };
  const char32_t first = byte(0);
  const size_t bytes = first < 0x80   ? 1
                       : first < 0xE0 ? 2
                       : first < 0xF0 ? 3
                                      : 4;
  if (bytes > text->size()) {
    text->remove_prefix(1);
    return first;
  }
  char32_t character = bytes == 1 ? first : first & (0x7FU >> bytes);
  for (size_t i = 1; i < bytes; ++i) {
    character = character << 6 | (byte(i) & 0x3F);
  }
  text->remove_prefix(bytes);
  return character;
}

bool IsSpace(char32_t c) {
  return c == ' ' || (c >= 0x09 && c <= 0x0D) || c == 0xA0 || c == 0x1680 ||
         (c >= 0x2000 && c <= 0x200A) || c == 0x2028 || c == 0x2029 ||
         c == 0x202F || c == 0x205F || c == 0x3000;
}

// Marks of direction, joiners, soft hyphens and the like.
bool IsInvisible(char32_t c) {
  return c == 0xAD || c == 0x034F || c == 0x061C || c == 0x180E ||
         (c >= 0x200B && c <= 0x200F) || (c >= 0x202A && c <= 0x202E) ||
         (c >= 0x2060 && c <= 0x206F) || (c >= 0xFE00 && c <= 0xFE0F) ||
         c == 0xFEFF;
}

bool IsAccent(char32_t c) { return c >= 0x0300 && c <= 0x036F; }

// A character without case and accents, as far as alphabets of Europe go.
char32_t Folded(char32_t c) {
  if (c >= 'A' && c <= 'Z') return c + 0x20;
  if (c >= 0xFF01 && c <= 0xFF5E) return Folded(c - 0xFEE0);
  if (c >= 0xC0 && c < 0x180) {
    const char base = kBaseLetters[c - 0xC0];
    if (base != '?') return static_cast<char32_t>(base);
  }
  // Greek and Cyrillic.
  if ((c >= 0x391 && c <= 0x3A9) || (c >= 0x410 && c <= 0x42F)) return c + 0x20;
  return c;
}

// Numbers that are written in several ways, "1" and "1.0", have one key.
std::string KeyOf(absl::string_view name) {
  // More digits than a double keeps are a name.
  constexpr size_t kMostDigits = 15;
  double number = 0;
  std::string digits;
  if (name.size() <= kMostDigits &&
      name.find_first_not_of("+-.0123456789") == absl::string_view::npos &&
      absl::SimpleAtod(name, &number)) {
    digits = absl::StrFormat("%.15g", number);
    name = digits;
  }
  std::u32string key;
  while (!name.empty()) {
    const char32_t c = TakeCharacter(&name);
    if (IsInvisible(c) || IsAccent(c)) continue;
    if (!IsSpace(c)) {
      key.push_back(Folded(c));
    } else if (!key.empty() && key.back() != ' ') {
      key.push_back(' ');
    }
  }
  if (!key.empty() && key.back() == ' ') key.pop_back();
  return std::string(reinterpret_cast<const char*>(key.data()),
                     key.size() * sizeof(char32_t));
}

}  // namespace

std::string TrimmedName(absl::string_view name) {
  absl::string_view rest = name;
  size_t begin = name.size();
  size_t end = 0;
  while (!rest.empty()) {
    const size_t at = name.size() - rest.size();
    const char32_t c = TakeCharacter(&rest);
    if (IsSpace(c) || IsInvisible(c)) continue;
    if (end == 0) begin = at;
    end = name.size() - rest.size();
  }
  return begin < end ? std::string(name.substr(begin, end - begin)) : "";
}

void SimilarNames::Add(const std::string& name) {
  if (!name.empty()) names_[KeyOf(name)].insert(name);
}

std::vector<std::string> SimilarNames::Remarks() const {
  std::vector<std::string> remarks;
  for (const auto& [key, names] : names_) {
    if (names.size() < 2) continue;
    if (remarks.size() == kMostRemarks) break;
    std::vector<std::string> quoted;
    for (const std::string& name : names) quoted.push_back(Quoted(name));
    remarks.push_back(absl::StrCat(
        "the ", what_, "s ", absl::StrJoin(quoted, " and "),
        " differ only by case, blanks, accents, the form of a number or "
        "characters that cannot be seen, and count as ",
        names.size(), "; write them alike if they mean the same"));
  }
  return remarks;
}

}  // namespace tactus::internal

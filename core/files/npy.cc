#include "core/files/npy.h"

#include <bit>
#include <cstring>
#include <type_traits>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/file_bytes.h"

namespace tactus {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied as they lie in the file");

constexpr absl::string_view kMagic = "\x93NUMPY";
constexpr size_t kMaxHeaderBytes = 64 * 1024;
// Texts of one array, and code points of one text.
constexpr size_t kMaxTexts = 1'000'000;
constexpr uint32_t kMaxTextLength = 100'000;

struct Header {
  std::string type;
  bool fortran_order = true;
  std::vector<size_t> shape;
};

// Splits the dictionary off the preamble and leaves the data in `bytes`.
absl::StatusOr<absl::string_view> TakeHeaderText(absl::string_view path,
                                                 absl::string_view* bytes) {
  if (!absl::ConsumePrefix(bytes, kMagic) || bytes->size() < 6) {
    return TrialFileInvalid(path, "is not a NumPy array file");
  }
  const auto byte = [&](size_t i) {
    return static_cast<size_t>(static_cast<unsigned char>((*bytes)[i]));
  };
  const size_t version = byte(0);
  if (version != 1 && version != 2) {
    return TrialFileInvalid(path, absl::StrCat("has NumPy format version ",
                                               version, "; use 1 or 2"));
  }
  const size_t preamble = version == 1 ? 4 : 6;
  size_t length = byte(2) | byte(3) << 8;
  if (version == 2) length |= byte(4) << 16 | byte(5) << 24;
  if (length > kMaxHeaderBytes || length > bytes->size() - preamble) {
    return TrialFileInvalid(
        path, absl::StrCat("its header of ", length, " bytes is cut short"));
  }
  const absl::string_view text = bytes->substr(preamble, length);
  bytes->remove_prefix(preamble + length);
  return text;
}

// "(605, 384)", "(5,)" or "()".
bool ParseShape(absl::string_view text, std::vector<size_t>* shape) {
  if (!absl::ConsumePrefix(&text, "(") || !absl::ConsumeSuffix(&text, ")")) {
    return false;
  }
  std::vector<absl::string_view> sizes = absl::StrSplit(text, ',');
  if (absl::StripAsciiWhitespace(sizes.back()).empty()) sizes.pop_back();
  for (const absl::string_view item : sizes) {
    uint32_t size = 0;
    if (!absl::SimpleAtoi(item, &size)) return false;
    shape->push_back(size);
  }
  return true;
}

// Takes "'key': value" off the front of a Python dictionary without nesting
// other than one pair of parentheses.
bool TakeItem(absl::string_view* text, absl::string_view* key,
              absl::string_view* value) {
  *text = absl::StripLeadingAsciiWhitespace(*text);
  if (!absl::ConsumePrefix(text, "'")) return false;
  const size_t quote = text->find('\'');
  if (quote == absl::string_view::npos) return false;
  *key = text->substr(0, quote);
  text->remove_prefix(quote + 1);
  *text = absl::StripLeadingAsciiWhitespace(*text);
  if (!absl::ConsumePrefix(text, ":")) return false;
  *text = absl::StripLeadingAsciiWhitespace(*text);
  const size_t start = absl::StartsWith(*text, "(") ? text->find(')') : 0;
  if (start == absl::string_view::npos) return false;
  const size_t end = text->find_first_of(",}", start);
  if (end == absl::string_view::npos) return false;
  *value = absl::StripTrailingAsciiWhitespace(text->substr(0, end));
  text->remove_prefix(end);
  absl::ConsumePrefix(text, ",");
  *text = absl::StripLeadingAsciiWhitespace(*text);
  return true;
}

bool ParseDictionary(absl::string_view text, Header* header) {
  text = absl::StripAsciiWhitespace(text);
  if (!absl::ConsumePrefix(&text, "{")) return false;
  int found = 0;
  while (!absl::StartsWith(text, "}")) {
    absl::string_view key;
    absl::string_view value;
    if (!TakeItem(&text, &key, &value)) return false;
    if (key == "descr") {
      header->type = std::string(value);
    } else if (key == "fortran_order") {
      if (value != "True" && value != "False") return false;
      header->fortran_order = value == "True";
    } else if (key != "shape" || !ParseShape(value, &header->shape)) {
      return false;
    }
    ++found;
  }
  return found == 3 && text == "}";
}

// The number of values that the shape calls for, if `data` has as many of
// `value_bytes` each.
absl::StatusOr<size_t> CountValues(absl::string_view path, const Header& header,
                                   absl::string_view data, size_t value_bytes) {
  size_t count = 1;
  for (const size_t size : header.shape) {
    // No overflow: count is at most 2^30 and size below 2^32.
    count *= size;
    if (count > limits::kMaxTrialArrayBytes) {
      return TrialFileInvalid(
          path, absl::StrCat("its shape calls for more than ",
                             limits::kMaxTrialArrayBytes, " values"));
    }
  }
  if (count * value_bytes != data.size()) {
    return TrialFileInvalid(
        path, absl::StrCat("has ", data.size(), " bytes of values; its shape ",
                           "calls for ", count * value_bytes));
  }
  return count;
}

// Converts each number of the file from `Stored` to `Value`.
template <typename Stored, typename Value>
absl::Status TakeValues(absl::string_view path, const Header& header,
                        absl::string_view data, std::vector<Value>* out) {
  TACTUS_ASSIGN_OR_RETURN(const size_t count,
                          CountValues(path, header, data, sizeof(Stored)));
  if (count > limits::kMaxTrialArrayBytes / sizeof(Value)) {
    return TrialFileInvalid(
        path,
        absl::StrCat("has ", count, " values; at most ",
                     limits::kMaxTrialArrayBytes / sizeof(Value), " are read"));
  }
  out->resize(count);
  if constexpr (std::is_same_v<Stored, Value>) {
    if (count > 0) std::memcpy(out->data(), data.data(), data.size());
  } else {
    for (size_t i = 0; i < count; ++i) {
      Stored value;
      std::memcpy(&value, data.data() + i * sizeof(Stored), sizeof(Stored));
      (*out)[i] = static_cast<Value>(value);
    }
  }
  return absl::OkStatus();
}

// Appends `code_point` in UTF-8. False if it is none.
bool AppendUtf8(uint32_t code_point, std::string* out) {
  const auto append = [&](uint32_t byte) {
    out->push_back(static_cast<char>(byte));
  };
  const auto append_rest = [&](int bytes) {
    for (int i = bytes - 1; i >= 0; --i) {
      append(0x80 | (code_point >> (6 * i) & 0x3F));
    }
  };
  if (code_point > 0x10FFFF || (code_point >= 0xD800 && code_point < 0xE000)) {
    return false;
  }
  if (code_point < 0x80) {
    append(code_point);
  } else if (code_point < 0x800) {
    append(0xC0 | code_point >> 6);
    append_rest(1);
  } else if (code_point < 0x10000) {
    append(0xE0 | code_point >> 12);
    append_rest(2);
  } else {
    append(0xF0 | code_point >> 18);
    append_rest(3);
  }
  return true;
}

// Each text has `length` code points of four bytes, zeros at its end.
absl::Status TakeText(absl::string_view path, const Header& header,
                      size_t length, absl::string_view data,
                      std::vector<std::string>* out) {
  constexpr size_t kCodePointBytes = 4;
  TACTUS_ASSIGN_OR_RETURN(
      const size_t count,
      CountValues(path, header, data, length * kCodePointBytes));
  if (count > kMaxTexts) {
    return TrialFileInvalid(
        path, absl::StrCat("has ", count, " texts; at most ", kMaxTexts,
                           " are read"));
  }
  for (size_t i = 0; i < count; ++i) {
    std::string& text = out->emplace_back();
    for (size_t k = 0; k < length; ++k) {
      uint32_t code_point = 0;
      std::memcpy(&code_point, data.data() + (i * length + k) * kCodePointBytes,
                  kCodePointBytes);
      if (!AppendUtf8(code_point, &text)) {
        return TrialFileInvalid(path, "holds text that is not Unicode");
      }
    }
    text.erase(text.find_last_not_of('\0') + 1);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<NpyArray> ParseNpy(absl::string_view path,
                                  absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(const absl::string_view text,
                          TakeHeaderText(path, &bytes));
  Header header;
  if (!ParseDictionary(text, &header)) {
    return TrialFileInvalid(path, "its NumPy header cannot be understood");
  }
  if (header.fortran_order) {
    return TrialFileInvalid(path, "is in Fortran order; save it in C order");
  }
  if (header.shape.size() > 4) {
    return TrialFileInvalid(path, absl::StrCat("has ", header.shape.size(),
                                               " dimensions; use at most 4"));
  }
  NpyArray array;
  array.shape = header.shape;
  absl::Status status;
  const std::string& type = header.type;
  absl::string_view digits = type;
  uint32_t length = 0;
  if (absl::ConsumePrefix(&digits, "'<U") &&
      absl::ConsumeSuffix(&digits, "'") && absl::SimpleAtoi(digits, &length) &&
      length <= kMaxTextLength) {
    status = TakeText(path, header, length, bytes, &array.text);
  } else if (type == "'|O'") {
    status = TrialFileInvalid(
        path,
        "holds '|O', Python objects in a pickle; pickles are never read. Save "
        "numbers or text");
  } else if (type == "'<u2'") {
    status = TakeValues<uint16_t>(path, header, bytes, &array.u16);
  } else if (type == "'<i8'") {
    status = TakeValues<int64_t>(path, header, bytes, &array.i64);
  } else if (type == "'<f4'") {
    status = TakeValues<float>(path, header, bytes, &array.f32);
  } else if (type == "'<f8'") {
    status = TakeValues<double>(path, header, bytes, &array.f64);
  } else if (type == "'|u1'" || type == "'|b1'") {
    status = TakeValues<uint8_t>(path, header, bytes, &array.f64);
  } else if (type == "'|i1'") {
    status = TakeValues<int8_t>(path, header, bytes, &array.f64);
  } else if (type == "'<i2'") {
    status = TakeValues<int16_t>(path, header, bytes, &array.f64);
  } else if (type == "'<i4'") {
    status = TakeValues<int32_t>(path, header, bytes, &array.f64);
  } else if (type == "'<u4'") {
    status = TakeValues<uint32_t>(path, header, bytes, &array.f64);
  } else {
    status = TrialFileInvalid(
        path, absl::StrCat("holds ", type,
                           "; use text or little-endian numbers of type f4, "
                           "f8, u1, u2, u4, i1, i2, i4 or i8"));
  }
  if (!status.ok()) return status;
  return array;
}

absl::StatusOr<NpyArray> ReadNpy(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxTrialArrayBytes));
  return ParseNpy(path, bytes);
}

}  // namespace tactus

#include "core/files/npy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/files/array_order.h"
#include "core/files/file_bytes.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied as they lie in the file");

constexpr absl::string_view kMagic = "\x93NUMPY";
constexpr size_t kMaxHeaderBytes = 64 * 1024;
// Texts of one array, and code points of one text.
constexpr size_t kMaxTexts = 1'000'000;
constexpr uint32_t kMaxTextLength = 100'000;

struct Header {
  // As in the file, e.g. "'<f4'".
  std::string type;
  bool big_endian = false;
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
  if (version < 1 || version > 3) {
    return TrialFileInvalid(path, absl::StrCat("has NumPy format version ",
                                               version, "; use 1 to 3"));
  }
  const size_t preamble = version == 1 ? 4 : 6;
  size_t length = byte(2) | byte(3) << 8;
  if (version >= 2) length |= byte(4) << 16 | byte(5) << 24;
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

// A number of 16 bits, IEEE 754 binary16.
struct Half {
  uint16_t bits = 0;

  explicit operator double() const {
    const int exponent = bits >> 10 & 0x1F;
    const double fraction = bits & 0x3FF;
    const double sign = (bits & 0x8000) != 0 ? -1 : 1;
    if (exponent == 0x1F) {
      return fraction == 0 ? sign * std::numeric_limits<double>::infinity()
                           : std::numeric_limits<double>::quiet_NaN();
    }
    return sign * (exponent == 0 ? std::ldexp(fraction, -24)
                                 : std::ldexp(1024 + fraction, exponent - 25));
  }
};

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
  for (size_t i = 0; i < count; ++i) {
    char bytes[sizeof(Stored)];
    std::memcpy(bytes, data.data() + i * sizeof(Stored), sizeof(Stored));
    if (header.big_endian) std::reverse(std::begin(bytes), std::end(bytes));
    Stored value;
    std::memcpy(&value, bytes, sizeof(Stored));
    (*out)[i] = static_cast<Value>(value);
  }
  if (header.fortran_order) *out = FromColumnsFirst(header.shape, *out);
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
      if (header.big_endian) code_point = __builtin_bswap32(code_point);
      if (!AppendUtf8(code_point, &text)) {
        return TrialFileInvalid(path, "holds text that is not Unicode");
      }
    }
    text.erase(text.find_last_not_of('\0') + 1);
  }
  if (header.fortran_order) *out = FromColumnsFirst(header.shape, *out);
  return absl::OkStatus();
}

absl::Status TakeArray(absl::string_view path, Header& header,
                       absl::string_view bytes, NpyArray* array) {
  // "'<f4'": the order of bytes, then the type.
  absl::string_view type = header.type;
  if (!absl::ConsumePrefix(&type, "'") || !absl::ConsumeSuffix(&type, "'")) {
    type = "";
  }
  header.big_endian = absl::ConsumePrefix(&type, ">");
  if (!header.big_endian && !absl::ConsumePrefix(&type, "<") &&
      !absl::ConsumePrefix(&type, "=")) {
    absl::ConsumePrefix(&type, "|");
  }
  absl::string_view digits = type;
  uint32_t length = 0;
  if (absl::ConsumePrefix(&digits, "U") && absl::SimpleAtoi(digits, &length) &&
      length <= kMaxTextLength) {
    return TakeText(path, header, length, bytes, &array->text);
  }
  if (type == "O") {
    return TrialFileInvalid(
        path,
        "holds '|O', Python objects in a pickle; pickles are never read. Save "
        "numbers or text");
  }
  if (type == "u2")
    return TakeValues<uint16_t>(path, header, bytes, &array->u16);
  if (type == "i2")
    return TakeValues<int16_t>(path, header, bytes, &array->i16);
  if (type == "i8")
    return TakeValues<int64_t>(path, header, bytes, &array->i64);
  if (type == "f4") return TakeValues<float>(path, header, bytes, &array->f32);
  std::vector<double>* const f64 = &array->f64;
  if (type == "f8") return TakeValues<double>(path, header, bytes, f64);
  if (type == "f2") return TakeValues<Half>(path, header, bytes, f64);
  if (type == "u1" || type == "b1") {
    return TakeValues<uint8_t>(path, header, bytes, f64);
  }
  if (type == "i1") return TakeValues<int8_t>(path, header, bytes, f64);
  if (type == "i4") return TakeValues<int32_t>(path, header, bytes, f64);
  if (type == "u4") return TakeValues<uint32_t>(path, header, bytes, f64);
  if (type == "u8") return TakeValues<uint64_t>(path, header, bytes, f64);
  return TrialFileInvalid(
      path, absl::StrCat("holds ", header.type,
                         "; use text or numbers of type f2, f4, f8, u1, u2, "
                         "u4, u8, i1, i2, i4 or i8"));
}

}  // namespace

absl::StatusOr<NpyArray> ParseNpy(absl::string_view path,
                                  absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(const absl::string_view text,
                          TakeHeaderText(path, &bytes));
  Header header;
  if (!ParseDictionary(text, &header)) {
    return TrialFileInvalid(
        path, absl::StrContains(text, "'descr': [")
                  ? "holds records with named fields; save their numbers as "
                    "one array, e.g. with "
                    "numpy.lib.recfunctions.structured_to_unstructured"
                  : "its NumPy header cannot be understood");
  }
  if (header.shape.size() > 4) {
    return TrialFileInvalid(path, absl::StrCat("has ", header.shape.size(),
                                               " dimensions; use at most 4"));
  }
  NpyArray array;
  array.shape = header.shape;
  TACTUS_RETURN_IF_ERROR(TakeArray(path, header, bytes, &array));
  return array;
}

absl::StatusOr<NpyArray> ReadNpy(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxTrialArrayBytes));
  return ParseNpy(path, bytes);
}

}  // namespace tactus::internal

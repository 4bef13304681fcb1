#include "core/files/npy_write.h"

#include <algorithm>
#include <bit>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "values are copied as they lie in memory");

template <typename Value>
std::string NumbersNpy(absl::string_view type, const std::vector<size_t>& shape,
                       std::span<const Value> values) {
  std::string bytes = NpyHeader(type, shape);
  bytes.append(reinterpret_cast<const char*>(values.data()),
               values.size_bytes());
  return bytes;
}

// The code points of well-formed UTF-8.
std::u32string CodePoints(absl::string_view text) {
  std::u32string points;
  for (const unsigned char byte : text) {
    if (byte < 0x80) {
      points += byte;
    } else if (byte >= 0xF0) {
      points += byte & 0x07;
    } else if (byte >= 0xE0) {
      points += byte & 0x0F;
    } else if (byte >= 0xC0) {
      points += byte & 0x1F;
    } else if (!points.empty()) {
      points.back() = points.back() << 6 | (byte & 0x3F);
    }
  }
  return points;
}

std::string Texts(const std::vector<size_t>& shape,
                  const std::vector<std::string>& texts) {
  std::vector<std::u32string> points;
  size_t length = 1;
  for (const std::string& text : texts) {
    points.push_back(CodePoints(text));
    length = std::max(length, points.back().size());
  }
  std::string bytes = NpyHeader(absl::StrCat("<U", length), shape);
  for (std::u32string& text : points) {
    text.resize(length);
    bytes.append(reinterpret_cast<const char*>(text.data()),
                 length * sizeof(char32_t));
  }
  return bytes;
}

}  // namespace

// Preamble and dictionary, padded so that the values begin at a multiple of 64.
std::string NpyHeader(absl::string_view type,
                      const std::vector<size_t>& shape) {
  constexpr size_t kPreamble = 10;
  constexpr size_t kAlignment = 64;
  std::string text = absl::StrCat(
      "{'descr': '", type, "', 'fortran_order': False, 'shape': (",
      absl::StrJoin(shape, ", "), shape.size() == 1 ? ",), }" : "), }");
  const size_t used = kPreamble + text.size() + 1;
  text.append((kAlignment - used % kAlignment) % kAlignment, ' ');
  text += '\n';
  std::string bytes = "\x93NUMPY\x01";
  bytes += '\0';
  bytes += static_cast<char>(text.size() % 256);
  bytes += static_cast<char>(text.size() / 256);
  return bytes + text;
}

std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const double> values) {
  return NumbersNpy("<f8", shape, values);
}

std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const float> values) {
  return NumbersNpy("<f4", shape, values);
}

std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const uint16_t> values) {
  return NumbersNpy("<u2", shape, values);
}

std::string NpyBytes(const std::vector<size_t>& shape,
                     std::span<const int16_t> values) {
  return NumbersNpy("<i2", shape, values);
}

std::string NpyText(const std::vector<std::string>& texts) {
  return Texts({texts.size()}, texts);
}

std::string NpyText(absl::string_view text) {
  return Texts({}, {std::string(text)});
}

}  // namespace tactus::internal

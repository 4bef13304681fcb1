#include "core/import/ros2/ros2_taxels.h"

#include <cstring>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

constexpr const char* kFields[] = {
    "data",   "magnetic_field", "sensors.values", "sensors.taxels",
    "taxels", "values",         "forces"};

const std::vector<double>* Find(const Ros2Message& message,
                                const std::string& path) {
  const auto found = message.numbers.find(path);
  return found == message.numbers.end() ? nullptr : &found->second;
}

double First(const Ros2Message& message, const std::string& path) {
  const std::vector<double>* const numbers = Find(message, path);
  return numbers == nullptr || numbers->empty() ? 0 : numbers->front();
}

absl::Status BadField(const std::string& field, absl::string_view fault) {
  return TrialFileInvalid(absl::StrCat("field ", Quoted(field)), fault);
}

// The pixels of an image, row by row.
absl::StatusOr<Ros2Taxels> PixelsOf(const Ros2Message& message) {
  const auto text = message.texts.find("encoding");
  const std::string encoding = text == message.texts.end() ? "" : text->second;
  size_t size = 0;
  if (encoding == "mono8" || encoding == "8UC1") size = 1;
  if (encoding == "mono16" || encoding == "16UC1") size = 2;
  if (encoding == "32FC1") size = 4;
  if (size == 0) {
    return BadField("data", absl::StrCat("is an image in ", Quoted(encoding),
                                         "; mono8, 8UC1, mono16, 16UC1 and "
                                         "32FC1 are read"));
  }
  Ros2Taxels taxels;
  taxels.field = "data";
  const auto rows = static_cast<size_t>(First(message, "height"));
  const auto columns = static_cast<size_t>(First(message, "width"));
  const auto step = static_cast<size_t>(First(message, "step"));
  const bool big_endian = First(message, "is_bigendian") != 0;
  const std::vector<double>* const bytes = Find(message, "data");
  const size_t found = bytes == nullptr ? 0 : bytes->size();
  // Factors are 32-bit numbers, so no product overflows.
  if (step < columns * size || rows * step != found || found == 0) {
    return BadField("data", absl::StrCat("has ", found, " bytes; ", rows, " x ",
                                         columns, " pixels in rows of ", step,
                                         " bytes were stated"));
  }
  taxels.shape = {rows, columns};
  for (size_t row = 0; row < rows; ++row) {
    for (size_t column = 0; column < columns; ++column) {
      uint32_t bits = 0;
      for (size_t i = 0; i < size; ++i) {
        const size_t at = row * step + column * size + i;
        const size_t shift = 8 * (big_endian ? size - 1 - i : i);
        bits |= static_cast<uint32_t>((*bytes)[at]) << shift;
      }
      float real = 0;
      std::memcpy(&real, &bits, sizeof(real));
      taxels.numbers.push_back(size == sizeof(real) ? real : bits);
    }
  }
  return taxels;
}

// The shape that the layout of a std_msgs/MultiArray states, if it fits.
void TakeLayout(const Ros2Message& message, Ros2Taxels& taxels) {
  std::vector<double>& numbers = taxels.numbers;
  const double offset = First(message, "layout.data_offset");
  const std::vector<double>* const sizes = Find(message, "layout.dim.size");
  if (sizes == nullptr || sizes->empty() || sizes->size() > 4) return;
  double product = 1;
  for (const double size : *sizes) product *= size;
  if (product == 0 || product + offset != static_cast<double>(numbers.size())) {
    return;
  }
  numbers.erase(numbers.begin(),
                numbers.begin() + static_cast<ptrdiff_t>(offset));
  taxels.shape.clear();
  for (const double size : *sizes) {
    taxels.shape.push_back(static_cast<size_t>(size));
  }
  if (taxels.shape.size() == 3 && taxels.shape.back() == 3) taxels.axes = 3;
}

// Sets the numbers if the message has the field with one.
absl::StatusOr<bool> TakeField(const Ros2Message& message,
                               const std::string& field, Ros2Taxels& taxels) {
  if (const auto* const numbers = Find(message, field)) {
    taxels.field = field;
    taxels.numbers = *numbers;
    taxels.shape = {numbers->size()};
    if (field == "data") TakeLayout(message, taxels);
    return true;
  }
  const std::vector<double>* axes[3];
  for (int i = 0; i < 3; ++i) {
    const char axis[] = {'.', static_cast<char>('x' + i), '\0'};
    axes[i] = Find(message, field + axis);
    if (axes[i] == nullptr) return false;
  }
  const size_t count = axes[0]->size();
  if (axes[1]->size() != count || axes[2]->size() != count) {
    return BadField(field, "has x, y and z of different lengths");
  }
  taxels.field = field;
  taxels.shape = {count, 3};
  taxels.axes = 3;
  for (size_t i = 0; i < count; ++i) {
    for (const auto* axis : axes) taxels.numbers.push_back((*axis)[i]);
  }
  return true;
}

std::string FieldNames(const Ros2Message& message) {
  constexpr size_t kMostNames = 20;
  std::vector<std::string> paths;
  for (const auto& [path, numbers] : message.numbers) {
    if (paths.size() == kMostNames) break;
    paths.push_back(path);
  }
  return paths.empty() ? "none" : Printable(absl::StrJoin(paths, ", "));
}

absl::Status NoField(const std::string& field, const Ros2Message& message) {
  return BadField(field,
                  absl::StrCat("is not in the message; its fields of numbers "
                               "are ",
                               FieldNames(message)));
}

// The only list of numbers, in a message of a type that nobody knows.
std::string OnlyList(const Ros2Message& message) {
  std::string only;
  for (const auto& [path, numbers] : message.numbers) {
    if (numbers.size() < 2 || absl::EndsWith(path, "covariance")) continue;
    if (!only.empty()) return "";
    only = path;
  }
  return only;
}

}  // namespace

absl::StatusOr<Ros2Taxels> TaxelsOf(const std::string& type,
                                    const Ros2Message& message,
                                    const std::string& field) {
  Ros2Taxels taxels;
  const bool image =
      absl::StartsWith(type, "sensor_msgs/") && absl::EndsWith(type, "/Image");
  if (image && (field.empty() || field == "data")) {
    return PixelsOf(message);
  }
  if (!field.empty()) {
    TACTUS_ASSIGN_OR_RETURN(const bool taken,
                            TakeField(message, field, taxels));
    if (!taken) return NoField(field, message);
    return taxels;
  }
  for (const char* const each : kFields) {
    TACTUS_ASSIGN_OR_RETURN(const bool taken, TakeField(message, each, taxels));
    if (taken && !taxels.numbers.empty()) return taxels;
  }
  if (const std::string only = OnlyList(message); !only.empty()) {
    TACTUS_RETURN_IF_ERROR(TakeField(message, only, taxels).status());
    return taxels;
  }
  return TrialFileInvalid(
      absl::StrCat("message of ", Quoted(type)),
      absl::StrCat("has no list of numbers that is taxels for sure; name one "
                   "in bag_values, of ",
                   FieldNames(message)));
}

absl::StatusOr<std::vector<double>> PoseNumbersOf(const Ros2Message& message) {
  for (const char* const prefix : {"", "pose.", "pose.pose."}) {
    std::vector<double> pose;
    for (const char* const name :
         {"position.x", "position.y", "position.z", "orientation.x",
          "orientation.y", "orientation.z", "orientation.w"}) {
      const auto* const numbers = Find(message, absl::StrCat(prefix, name));
      if (numbers != nullptr && numbers->size() == 1) {
        pose.push_back(numbers->front());
      }
    }
    if (pose.size() == 7) return pose;
  }
  return NoField("pose", message);
}

}  // namespace tactus::internal

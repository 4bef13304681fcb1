#include "core/import/ros_message.h"

#include <cstdint>
#include <cstring>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"

namespace tactus::internal {
namespace {

constexpr char kMessage[] = "ROS message";
// Types within types.
constexpr int kMaxDepth = 16;
// Elements of one array, also of a type without bytes.
constexpr uint32_t kMaxElements = 10'000'000;

// Bytes of a type of numbers; 0 for other types.
size_t SizeOf(absl::string_view type) {
  static const auto* const sizes = new std::map<absl::string_view, size_t>{
      {"bool", 1},    {"int8", 1},  {"uint8", 1},   {"byte", 1},
      {"char", 1},    {"int16", 2}, {"uint16", 2},  {"int32", 4},
      {"uint32", 4},  {"int64", 8}, {"uint64", 8},  {"float32", 4},
      {"float64", 8}, {"time", 8},  {"duration", 8}};
  const auto found = sizes->find(type);
  return found == sizes->end() ? 0 : found->second;
}

template <typename T>
double NumberAs(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof(value));
  return static_cast<double>(value);
}

double NumberOf(absl::string_view type, const char* bytes) {
  constexpr double kNanosecond = 1e-9;
  if (type == "float64") return NumberAs<double>(bytes);
  if (type == "float32") return NumberAs<float>(bytes);
  if (type == "int8" || type == "byte") return NumberAs<int8_t>(bytes);
  if (type == "int16") return NumberAs<int16_t>(bytes);
  if (type == "uint16") return NumberAs<uint16_t>(bytes);
  if (type == "int32") return NumberAs<int32_t>(bytes);
  if (type == "uint32") return NumberAs<uint32_t>(bytes);
  if (type == "int64") return NumberAs<int64_t>(bytes);
  if (type == "uint64") return NumberAs<uint64_t>(bytes);
  if (type == "time") {
    return NumberAs<uint32_t>(bytes) +
           kNanosecond * NumberAs<uint32_t>(bytes + 4);
  }
  if (type == "duration") {
    return NumberAs<int32_t>(bytes) +
           kNanosecond * NumberAs<int32_t>(bytes + 4);
  }
  return NumberAs<uint8_t>(bytes);
}

}  // namespace

// Walks through the bytes of one message.
class RosMessageType::Reader {
 public:
  Reader(const RosMessageType& type, absl::string_view bytes)
      : type_(type), rest_(bytes) {}

  absl::StatusOr<RosNumbers> Run() {
    TACTUS_RETURN_IF_ERROR(Fields("", "", 0));
    if (!rest_.empty()) {
      return TrialFileInvalid(
          kMessage, absl::StrCat("has ", rest_.size(), " bytes too many"));
    }
    return std::move(numbers_);
  }

 private:
  absl::Status Fields(const std::string& type, const std::string& prefix,
                      int depth) {
    if (depth > kMaxDepth) {
      return TrialFileInvalid(kMessage, "has types within types without end");
    }
    for (const Field& field : type_.types_.at(type)) {
      const std::string path = prefix + field.name;
      uint32_t count = 1;
      if (field.is_array && field.count < 0) {
        TACTUS_ASSIGN_OR_RETURN(count, Length(path));
      } else if (field.is_array) {
        count = static_cast<uint32_t>(field.count);
      }
      if (count > kMaxElements) return TooShort(path);
      TACTUS_RETURN_IF_ERROR(Elements(field, path, count, depth));
    }
    return absl::OkStatus();
  }

  absl::Status Elements(const Field& field, const std::string& path,
                        uint32_t count, int depth) {
    if (const size_t size = SizeOf(field.type); size > 0) {
      if (rest_.size() / size < count) return TooShort(path);
      std::vector<double>& numbers = numbers_[path];
      for (uint32_t i = 0; i < count; ++i) {
        numbers.push_back(NumberOf(field.type, rest_.data() + i * size));
      }
      rest_.remove_prefix(count * size);
      return absl::OkStatus();
    }
    for (uint32_t i = 0; i < count; ++i) {
      if (field.type == "string") {
        TACTUS_ASSIGN_OR_RETURN(const uint32_t length, Length(path));
        if (rest_.size() < length) return TooShort(path);
        rest_.remove_prefix(length);
      } else {
        TACTUS_RETURN_IF_ERROR(
            Fields(type_.Resolve(field.type), path + ".", depth + 1));
      }
    }
    return absl::OkStatus();
  }

  absl::StatusOr<uint32_t> Length(const std::string& path) {
    uint32_t length = 0;
    if (rest_.size() < sizeof(length)) return TooShort(path);
    std::memcpy(&length, rest_.data(), sizeof(length));
    rest_.remove_prefix(sizeof(length));
    return length;
  }

  static absl::Status TooShort(const std::string& path) {
    return TrialFileInvalid(kMessage, absl::StrCat("ends within ", path));
  }

  const RosMessageType& type_;
  absl::string_view rest_;
  RosNumbers numbers_;
};

absl::StatusOr<RosMessageType> RosMessageType::Parse(
    absl::string_view definition) {
  RosMessageType type;
  std::string current;
  type.types_[current];
  for (absl::string_view line : absl::StrSplit(definition, '\n')) {
    line = absl::StripAsciiWhitespace(line.substr(0, line.find('#')));
    if (line.empty() || absl::StartsWith(line, "===")) continue;
    if (absl::ConsumePrefix(&line, "MSG:")) {
      current = std::string(absl::StripAsciiWhitespace(line));
      type.types_[current];
      continue;
    }
    const std::vector<std::string> words =
        absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    // A constant takes no bytes.
    if (absl::StrContains(line, "=")) continue;
    if (words.size() != 2) {
      return TrialFileInvalid(
          kMessage, absl::StrCat("definition: ", Quoted(line), " is no field"));
    }
    Field field{.type = words[0], .name = words[1]};
    const size_t bracket = field.type.find('[');
    if (bracket != std::string::npos) {
      absl::string_view count = absl::string_view(field.type).substr(bracket);
      field.is_array = true;
      if (!absl::ConsumePrefix(&count, "[") ||
          !absl::ConsumeSuffix(&count, "]") ||
          (!count.empty() &&
           (!absl::SimpleAtoi(count, &field.count) || field.count < 0))) {
        return TrialFileInvalid(
            kMessage,
            absl::StrCat("definition: ", Quoted(line), " is no field"));
      }
      field.type.resize(bracket);
    }
    type.types_[current].push_back(std::move(field));
  }
  for (const auto& [name, fields] : type.types_) {
    for (const Field& field : fields) {
      if (SizeOf(field.type) > 0 || field.type == "string" ||
          !type.Resolve(field.type).empty()) {
        continue;
      }
      return TrialFileInvalid(
          kMessage, absl::StrCat("definition: the type ", Quoted(field.type),
                                 " of ", Quoted(field.name), " is missing"));
    }
  }
  return type;
}

std::string RosMessageType::Resolve(const std::string& type) const {
  if (type.empty()) return "";
  if (types_.contains(type)) return type;
  // Types of the same package, and Header, are written without a package.
  const std::string ending = "/" + type;
  for (const auto& [name, fields] : types_) {
    if (absl::EndsWith(name, ending)) return name;
  }
  return "";
}

absl::StatusOr<RosNumbers> RosMessageType::Read(absl::string_view bytes) const {
  return Reader(*this, bytes).Run();
}

}  // namespace tactus::internal

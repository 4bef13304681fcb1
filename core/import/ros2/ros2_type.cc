#include "core/import/ros2/ros2_type.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits_bags.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/import/ros2/ros2_built_in.h"

namespace tactus::internal {
namespace {

// Fields of an empty message: CDR gives it one byte.
constexpr char kNoField[] = "uint8 structure_needs_at_least_one_member";

// "package/msg/Type" as "package/Type".
std::string ShortName(absl::string_view name) {
  return absl::StrReplaceAll(name, {{"/msg/", "/"}});
}

absl::Status BadType(const std::string& name, absl::string_view fault) {
  return TrialFileInvalid(absl::StrCat("type ", Quoted(name)), fault);
}

using ReadNumber = double (*)(CdrReader&);

template <typename Value>
double ReadAs(CdrReader& reader) {
  return static_cast<double>(reader.Number<Value>());
}

// Null for types that are no numbers.
ReadNumber ReaderOf(absl::string_view type) {
  static const auto* const readers =
      new std::map<absl::string_view, ReadNumber>{
          {"bool", ReadAs<uint8_t>},    {"byte", ReadAs<uint8_t>},
          {"char", ReadAs<uint8_t>},    {"int8", ReadAs<int8_t>},
          {"uint8", ReadAs<uint8_t>},   {"int16", ReadAs<int16_t>},
          {"uint16", ReadAs<uint16_t>}, {"int32", ReadAs<int32_t>},
          {"uint32", ReadAs<uint32_t>}, {"int64", ReadAs<int64_t>},
          {"uint64", ReadAs<uint64_t>}, {"float32", ReadAs<float>},
          {"float64", ReadAs<double>}};
  const auto found = readers->find(type);
  return found == readers->end() ? nullptr : found->second;
}

}  // namespace

// Walks through the bytes of one message.
class Ros2Type::Walk {
 public:
  Walk(const Ros2Type& type, absl::string_view bytes)
      : type_(type), reader_(bytes) {}

  absl::StatusOr<Ros2Message> Run() {
    TACTUS_RETURN_IF_ERROR(Fields(ShortName(type_.name_), "", 0));
    if (!reader_.good()) return Invalid(reader_.fault());
    // Some writers fill the last four bytes.
    if (reader_.left() >= sizeof(uint32_t)) {
      return Invalid(absl::StrCat("has ", reader_.left(), " bytes too many"));
    }
    return std::move(message_);
  }

 private:
  absl::Status Fields(const std::string& type, const std::string& prefix,
                      int depth) {
    if (depth > limits::kMaxBagDepth) {
      return Invalid("has types within types without end");
    }
    const auto fields = type_.types_.find(type);
    if (fields == type_.types_.end()) {
      return Invalid(absl::StrCat("needs the type ", Quoted(type),
                                  ", whose definition is missing"));
    }
    for (const Field& field : fields->second) {
      const std::string path = prefix + field.name;
      uint64_t count = 1;
      if (field.is_array) {
        count = field.count < 0 ? reader_.Number<uint32_t>()
                                : static_cast<uint64_t>(field.count);
      }
      TACTUS_RETURN_IF_ERROR(Elements(field, path, count, depth));
      if (!reader_.good()) {
        return Invalid(absl::StrCat(reader_.fault(), ", within ", path));
      }
    }
    return absl::OkStatus();
  }

  absl::Status Elements(const Field& field, const std::string& path,
                        uint64_t count, int depth) {
    const ReadNumber read = ReaderOf(field.type);
    steps_ += 1 + (read != nullptr ? 0 : count);
    numbers_ += read != nullptr ? count : 0;
    if (steps_ > limits::kMaxBagSteps || numbers_ > limits::kMaxBagNumbers) {
      return Invalid(absl::StrCat("has too many parts, within ", path,
                                  "; the limit is ", limits::kMaxBagNumbers,
                                  " numbers and ", limits::kMaxBagSteps,
                                  " other parts"));
    }
    if (read != nullptr) {
      std::vector<double>& numbers = message_.numbers[path];
      for (uint64_t i = 0; i < count && reader_.good(); ++i) {
        numbers.push_back(read(reader_));
      }
      return absl::OkStatus();
    }
    for (uint64_t i = 0; i < count && reader_.good(); ++i) {
      if (field.type == "string") {
        const absl::string_view text = reader_.Text();
        if (text.size() <= limits::kMaxBagTextBytes) {
          message_.texts[path] = std::string(text);
        }
      } else if (field.type == "wstring") {
        return Invalid(
            absl::StrCat("has a wstring, which is not read: ", path));
      } else {
        TACTUS_RETURN_IF_ERROR(Fields(field.type, path + ".", depth + 1));
      }
    }
    return absl::OkStatus();
  }

  absl::Status Invalid(absl::string_view fault) const {
    return TrialFileInvalid(absl::StrCat("message of ", Quoted(type_.name_)),
                            fault);
  }

  const Ros2Type& type_;
  CdrReader reader_;
  Ros2Message message_;
  uint64_t numbers_ = 0;
  uint64_t steps_ = 0;
};

absl::Status Ros2Type::ParseFields(const std::string& type,
                                   absl::string_view text) {
  const std::string package = type.substr(0, type.find('/'));
  std::vector<Field>& fields = types_[type];
  for (absl::string_view line : absl::StrSplit(text, '\n')) {
    line = absl::StripAsciiWhitespace(line.substr(0, line.find('#')));
    if (line.empty()) continue;
    const std::vector<absl::string_view> words =
        absl::StrSplit(line, absl::ByAnyChar(" \t"), absl::SkipEmpty());
    if (words.size() < 2) {
      return BadType(type, absl::StrCat(Quoted(line), " is no field"));
    }
    // A constant takes no bytes. A length may be bounded: string<=5.
    if (absl::StrContains(words[1], '=') ||
        (words.size() > 2 && words[2][0] == '=')) {
      continue;
    }
    if (words[1].size() > limits::kMaxBagNameBytes) {
      return BadType(type, absl::StrCat("has a field whose name has ",
                                        words[1].size(), " bytes"));
    }
    if (fields.size() >= limits::kMaxBagFields) {
      return BadType(type, absl::StrCat("has more than ", limits::kMaxBagFields,
                                        " fields"));
    }
    Field field;
    field.name = std::string(words[1]);
    absl::string_view base = words[0];
    const size_t bracket = base.find('[');
    if (bracket != absl::string_view::npos) {
      absl::string_view count = base.substr(bracket + 1);
      field.is_array = true;
      if (!absl::ConsumeSuffix(&count, "]") ||
          (!count.empty() && !absl::StartsWith(count, "<=") &&
           !absl::SimpleAtoi(count, &field.count)) ||
          field.count < -1) {
        return BadType(type, absl::StrCat(Quoted(line), " is no field"));
      }
      base = base.substr(0, bracket);
    }
    base = base.substr(0, base.find('<'));
    field.type = ShortName(base);
    const bool plain = ReaderOf(field.type) != nullptr ||
                       field.type == "string" || field.type == "wstring";
    if (field.type == "Header") field.type = "std_msgs/Header";
    if (!plain && !absl::StrContains(field.type, '/')) {
      field.type = absl::StrCat(package, "/", field.type);
    }
    fields.push_back(std::move(field));
  }
  if (fields.empty()) return ParseFields(type, kNoField);
  return absl::OkStatus();
}

absl::Status Ros2Type::Complete() {
  // Built-in types name only built-in types, and never themselves.
  bool added = true;
  while (added) {
    added = false;
    std::vector<std::string> missing;
    for (const auto& [name, fields] : types_) {
      for (const Field& field : fields) {
        if (types_.contains(field.type)) continue;
        if (BuiltInRos2Type(field.type).data() != nullptr) {
          missing.push_back(field.type);
        }
      }
    }
    for (const std::string& name : missing) {
      if (types_.contains(name)) continue;
      TACTUS_RETURN_IF_ERROR(ParseFields(name, BuiltInRos2Type(name)));
      added = true;
    }
  }
  return absl::OkStatus();
}

bool Ros2Type::IsBuiltIn(const std::string& name) {
  return BuiltInRos2Type(ShortName(name)).data() != nullptr;
}

absl::StatusOr<Ros2Type> Ros2Type::Parse(const std::string& name,
                                         absl::string_view definition) {
  Ros2Type type;
  type.name_ = name;
  const std::string root = ShortName(name);
  if (definition.size() > limits::kMaxBagDefinitionBytes) {
    return BadType(name, absl::StrCat("has a definition of ", definition.size(),
                                      " bytes; the limit is ",
                                      limits::kMaxBagDefinitionBytes));
  }
  if (absl::StripAsciiWhitespace(definition).empty()) {
    definition = BuiltInRos2Type(root);
    if (definition.data() == nullptr) {
      return BadType(name,
                     "has no definition in the bag, and none is built in");
    }
  }
  std::string current = root;
  std::string text;
  for (const absl::string_view line : absl::StrSplit(definition, '\n')) {
    absl::string_view rest = absl::StripAsciiWhitespace(line);
    if (absl::StartsWith(rest, "===")) continue;
    if (!absl::ConsumePrefix(&rest, "MSG:")) {
      absl::StrAppend(&text, line, "\n");
      continue;
    }
    TACTUS_RETURN_IF_ERROR(type.ParseFields(current, text));
    current = ShortName(absl::StripAsciiWhitespace(rest));
    text.clear();
    // The first definition of a type counts.
    if (type.types_.contains(current)) {
      return BadType(name, absl::StrCat("defines ", Quoted(current), " twice"));
    }
  }
  TACTUS_RETURN_IF_ERROR(type.ParseFields(current, text));
  TACTUS_RETURN_IF_ERROR(type.Complete());
  return type;
}

absl::StatusOr<Ros2Message> Ros2Type::Read(absl::string_view bytes) const {
  return Walk(*this, bytes).Run();
}

}  // namespace tactus::internal

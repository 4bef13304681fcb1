#include "tests/proto/breaking_changes.h"

#include <map>

#include "absl/strings/str_cat.h"

namespace tactus::internal {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::EnumDescriptorProto;
using google::protobuf::FieldDescriptorProto;
using google::protobuf::FileDescriptorSet;
using google::protobuf::MethodDescriptorProto;

// Every element by its full name.
struct Contract {
  std::map<std::string, const DescriptorProto*> messages;
  std::map<std::string, const EnumDescriptorProto*> enums;
  std::map<std::string, const MethodDescriptorProto*> methods;

  explicit Contract(const FileDescriptorSet& files) {
    for (const auto& file : files.file()) {
      for (const auto& message : file.message_type()) {
        Add(file.package(), message);
      }
      for (const auto& type : file.enum_type()) {
        enums[absl::StrCat(file.package(), ".", type.name())] = &type;
      }
      for (const auto& service : file.service()) {
        for (const auto& method : service.method()) {
          methods[absl::StrCat(file.package(), ".", service.name(), "/",
                               method.name())] = &method;
        }
      }
    }
  }

 private:
  void Add(const std::string& scope, const DescriptorProto& message) {
    const std::string name = absl::StrCat(scope, ".", message.name());
    messages[name] = &message;
    for (const auto& nested : message.nested_type()) Add(name, nested);
    for (const auto& type : message.enum_type()) {
      enums[absl::StrCat(name, ".", type.name())] = &type;
    }
  }
};

// What a field is on the wire and in generated code.
std::string Meaning(const DescriptorProto& message,
                    const FieldDescriptorProto& field) {
  return absl::StrCat(FieldDescriptorProto::Label_Name(field.label()), " ",
                      FieldDescriptorProto::Type_Name(field.type()), " ",
                      field.type_name(), " ", field.name(), " in oneof ",
                      field.has_oneof_index()
                          ? message.oneof_decl(field.oneof_index()).name()
                          : "none");
}

std::map<int, std::string> Fields(const DescriptorProto& message) {
  std::map<int, std::string> fields;
  for (const auto& field : message.field()) {
    fields[field.number()] = Meaning(message, field);
  }
  return fields;
}

std::map<int, std::string> Values(const EnumDescriptorProto& type) {
  std::map<int, std::string> values;
  for (const auto& value : type.value()) values[value.number()] = value.name();
  return values;
}

class Comparison {
 public:
  Comparison(const Contract& before, const Contract& after) {
    for (const auto& [name, message] : before.messages) {
      const auto found = after.messages.find(name);
      if (found == after.messages.end()) {
        Complain(name, "message is gone");
      } else {
        Numbers(name, Fields(*message), Fields(*found->second));
      }
    }
    for (const auto& [name, type] : before.enums) {
      const auto found = after.enums.find(name);
      if (found == after.enums.end()) {
        Complain(name, "enum is gone");
      } else {
        Numbers(name, Values(*type), Values(*found->second));
      }
    }
    for (const auto& [name, method] : before.methods) {
      const auto found = after.methods.find(name);
      if (found == after.methods.end()) {
        Complain(name, "RPC is gone");
      } else if (Shape(*method) != Shape(*found->second)) {
        Complain(name, absl::StrCat("was ", Shape(*method), ", is ",
                                    Shape(*found->second)));
      }
    }
  }

  std::vector<std::string> complaints() const { return complaints_; }

 private:
  static std::string Shape(const MethodDescriptorProto& method) {
    return absl::StrCat(
        method.client_streaming() ? "stream " : "", method.input_type(), " -> ",
        method.server_streaming() ? "stream " : "", method.output_type());
  }

  void Numbers(const std::string& place,
               const std::map<int, std::string>& before,
               const std::map<int, std::string>& after) {
    for (const auto& [number, meaning] : before) {
      const auto found = after.find(number);
      if (found == after.end()) {
        Complain(place,
                 absl::StrCat("number ", number, ", ", meaning, ", is gone"));
      } else if (found->second != meaning) {
        Complain(place, absl::StrCat("number ", number, " was ", meaning,
                                     ", is ", found->second));
      }
    }
  }

  void Complain(const std::string& place, const std::string& what) {
    complaints_.push_back(absl::StrCat(place, ": ", what));
  }

  std::vector<std::string> complaints_;
};

}  // namespace

std::vector<std::string> BreakingChanges(const FileDescriptorSet& before,
                                         const FileDescriptorSet& after) {
  return Comparison(Contract(before), Contract(after)).complaints();
}

}  // namespace tactus::internal

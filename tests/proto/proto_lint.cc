#include "tests/proto/proto_lint.h"

#include <algorithm>
#include <map>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace tactus::internal {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::EnumDescriptorProto;
using google::protobuf::FileDescriptorProto;
using google::protobuf::FileDescriptorSet;
using google::protobuf::ServiceDescriptorProto;
using Path = std::vector<int>;

bool IsPascal(const std::string& name) {
  return !name.empty() && absl::ascii_isupper(name[0]) &&
         name.find('_') == std::string::npos;
}

bool IsLowerSnake(const std::string& name) {
  for (const char c : name) {
    if (!absl::ascii_islower(c) && !absl::ascii_isdigit(c) && c != '_') {
      return false;
    }
  }
  return !name.empty() && absl::ascii_islower(name[0]) && name.back() != '_' &&
         !absl::StrContains(name, "__");
}

// "TaxelUnit" -> "TAXEL_UNIT_".
std::string ValuePrefix(const std::string& name) {
  std::string prefix;
  for (size_t i = 0; i < name.size(); ++i) {
    if (i > 0 && absl::ascii_isupper(name[i])) prefix += '_';
    prefix += absl::ascii_toupper(name[i]);
  }
  return prefix + "_";
}

Path Child(Path path, int field, int index) {
  path.push_back(field);
  path.push_back(index);
  return path;
}

class Linter {
 public:
  explicit Linter(const FileDescriptorProto& file) : file_(file) {
    for (const auto& location : file.source_code_info().location()) {
      const Path path(location.path().begin(), location.path().end());
      comments_[path] = location.leading_comments();
      if (location.leading_detached_comments_size() > 0) {
        detached_.insert({path, location.leading_detached_comments(0)});
      }
    }
  }

  std::vector<std::string> Run() {
    const std::string directory =
        file_.name().substr(0, file_.name().rfind('/'));
    if (absl::StrReplaceAll(directory, {{"/", "."}}) != file_.package()) {
      Complain(file_.name(),
               "its folder is not that of package " + file_.package());
    }
    if (file_.package() != "tactus.v1") {
      Complain(file_.name(), "its package must be tactus.v1");
    }
    if (file_.syntax() != "proto3") Complain(file_.name(), "must be proto3");
    NeedComment({FileDescriptorProto::kSyntaxFieldNumber}, file_.name());
    for (int i = 0; i < file_.message_type_size(); ++i) {
      Message(file_.message_type(i),
              {FileDescriptorProto::kMessageTypeFieldNumber, i});
    }
    for (int i = 0; i < file_.enum_type_size(); ++i) {
      Enum(file_.enum_type(i), {FileDescriptorProto::kEnumTypeFieldNumber, i});
    }
    for (int i = 0; i < file_.service_size(); ++i) {
      Service(file_.service(i), {FileDescriptorProto::kServiceFieldNumber, i});
    }
    return complaints_;
  }

 private:
  void Complain(const std::string& place, const std::string& what) {
    complaints_.push_back(absl::StrCat(place, ": ", what));
  }

  void NeedComment(const Path& path, const std::string& place) {
    const auto comment = comments_.find(path);
    const bool attached = comment != comments_.end() &&
                          !absl::StripAsciiWhitespace(comment->second).empty();
    if (!attached && !detached_.contains(path)) {
      Complain(place, "has no comment");
    }
  }

  void Message(const DescriptorProto& message, const Path& path) {
    if (!IsPascal(message.name())) {
      Complain(message.name(), "messages are named in PascalCase");
    }
    NeedComment(path, message.name());
    for (int i = 0; i < message.field_size(); ++i) {
      const std::string place =
          absl::StrCat(message.name(), ".", message.field(i).name());
      if (!IsLowerSnake(message.field(i).name())) {
        Complain(place, "fields are named in lower_snake_case");
      }
      NeedComment(Child(path, DescriptorProto::kFieldFieldNumber, i), place);
    }
    for (int i = 0; i < message.oneof_decl_size(); ++i) {
      // That of an optional field is made by the compiler.
      const bool made = std::any_of(
          message.field().begin(), message.field().end(),
          [i](const auto& field) {
            return field.proto3_optional() && field.oneof_index() == i;
          });
      if (made) continue;
      const std::string place =
          absl::StrCat(message.name(), ".", message.oneof_decl(i).name());
      if (!IsLowerSnake(message.oneof_decl(i).name())) {
        Complain(place, "oneofs are named in lower_snake_case");
      }
      NeedComment(Child(path, DescriptorProto::kOneofDeclFieldNumber, i),
                  place);
    }
    for (int i = 0; i < message.enum_type_size(); ++i) {
      Enum(message.enum_type(i),
           Child(path, DescriptorProto::kEnumTypeFieldNumber, i));
    }
    for (int i = 0; i < message.nested_type_size(); ++i) {
      // A map's entry type is made by the compiler.
      if (message.nested_type(i).options().map_entry()) continue;
      Message(message.nested_type(i),
              Child(path, DescriptorProto::kNestedTypeFieldNumber, i));
    }
  }

  void Enum(const EnumDescriptorProto& type, const Path& path) {
    const std::string prefix = ValuePrefix(type.name());
    if (!IsPascal(type.name())) {
      Complain(type.name(), "enums are named in PascalCase");
    }
    NeedComment(path, type.name());
    for (int i = 0; i < type.value_size(); ++i) {
      const std::string& name = type.value(i).name();
      if (!absl::StartsWith(name, prefix)) {
        Complain(name, "its name must begin with " + prefix);
      }
      if (absl::AsciiStrToUpper(name) != name) {
        Complain(name, "enum values are named in UPPER_SNAKE_CASE");
      }
      const bool zero = type.value(i).number() == 0;
      if (zero != (name == prefix + "UNSPECIFIED")) {
        Complain(name,
                 "the value 0, and only it, is " + prefix + "UNSPECIFIED");
      }
      NeedComment(Child(path, EnumDescriptorProto::kValueFieldNumber, i), name);
    }
  }

  void Service(const ServiceDescriptorProto& service, const Path& path) {
    if (!IsPascal(service.name()) ||
        !absl::EndsWith(service.name(), "Service")) {
      Complain(service.name(), "services are named like ThisService");
    }
    NeedComment(path, service.name());
    for (int i = 0; i < service.method_size(); ++i) {
      const auto& method = service.method(i);
      const std::string place =
          absl::StrCat(service.name(), ".", method.name());
      if (!IsPascal(method.name())) {
        Complain(place, "RPCs are named in PascalCase");
      }
      NeedMessage(place, method.input_type(), method.name() + "Request");
      NeedMessage(place, method.output_type(), method.name() + "Response");
      NeedComment(Child(path, ServiceDescriptorProto::kMethodFieldNumber, i),
                  place);
    }
  }

  void NeedMessage(const std::string& place, const std::string& type,
                   const std::string& want) {
    if (type.substr(type.rfind('.') + 1) != want) {
      Complain(place, absl::StrCat("uses ", type, "; it must be ", want));
    }
  }

  const FileDescriptorProto& file_;
  std::map<Path, std::string> comments_;
  std::map<Path, std::string> detached_;
  std::vector<std::string> complaints_;
};

}  // namespace

std::vector<std::string> Lint(const FileDescriptorProto& file) {
  return Linter(file).Run();
}

std::vector<std::string> SharedMessages(const FileDescriptorSet& files) {
  std::vector<std::string> complaints;
  std::map<std::string, std::string> users;
  const auto use = [&](const std::string& type, const std::string& rpc) {
    const auto [first, fresh] = users.insert({type, rpc});
    if (fresh) return;
    complaints.push_back(
        absl::StrCat(type, ": is used by ", first->second, " and ", rpc));
  };
  for (const FileDescriptorProto& file : files.file()) {
    for (const ServiceDescriptorProto& service : file.service()) {
      for (const auto& method : service.method()) {
        const std::string rpc =
            absl::StrCat(service.name(), ".", method.name());
        use(method.input_type(), rpc);
        use(method.output_type(), rpc);
      }
    }
  }
  return complaints;
}

}  // namespace tactus::internal

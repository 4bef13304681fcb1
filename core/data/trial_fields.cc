#include "core/data/trial_fields.h"

#include <array>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"

namespace tactus::internal {
namespace {

struct Field {
  const char* name;
  std::string (*value)(const Trial& trial);
};

constexpr std::array<Field, 8> kFields = {{
    {"trial", [](const Trial& t) { return t.id; }},
    {"source", [](const Trial& t) { return t.source; }},
    {"label", [](const Trial& t) { return t.label; }},
    {"condition", [](const Trial& t) { return t.condition; }},
    {"object", [](const Trial& t) { return t.object; }},
    {"group", [](const Trial& t) { return t.material; }},
    {"stiffness", [](const Trial& t) { return absl::StrCat(t.stiffness); }},
    {"velocity", [](const Trial& t) { return absl::StrCat(t.velocity); }},
}};

const Field* Find(const std::string& name) {
  for (const Field& field : kFields) {
    if (name == field.name) return &field;
  }
  return nullptr;
}

}  // namespace

absl::Status CheckTrialFields(const std::vector<std::string>& fields) {
  for (const std::string& name : fields) {
    if (Find(name) != nullptr) continue;
    return InvalidConfig(
        "field of trials", name,
        absl::StrCat("one of ",
                     absl::StrJoin(kFields, ", ",
                                   [](std::string* out, const Field& field) {
                                     out->append(field.name);
                                   })));
  }
  return absl::OkStatus();
}

std::string TrialField(const Trial& trial, const std::string& field) {
  return Find(field)->value(trial);
}

}  // namespace tactus::internal

// The examples of public headers, as their comments show them. They only have
// to compile; HouseTest.ExamplesAreCompiled compares the texts.
#include <string>

#include "core/access/access_table.h"
#include "core/access/role.h"
#include "core/base/status_macros.h"

namespace tactus::examples {

void Print(absl::string_view text);
void Use(const std::string& name);

absl::Status RoleExample() {
  TACTUS_ASSIGN_OR_RETURN(const Role role, ParseRole("trainer"));
  if (role < Role::kAdmin) Print(RoleName(role));
  return absl::OkStatus();
}

absl::Status AccessTableExample(absl::string_view text,
                                absl::string_view token) {
  TACTUS_ASSIGN_OR_RETURN(const AccessTable table, AccessTable::Parse(text));
  const AccessTable::Entry* entry = table.FindToken(token);
  if (entry != nullptr && entry->role >= Role::kTrainer) Use(entry->name);
  return absl::OkStatus();
}

}  // namespace tactus::examples

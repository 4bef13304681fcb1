#include "core/access/role.h"

#include "core/base/errors.h"
#include "core/base/text.h"

namespace tactus::internal {

absl::string_view RoleName(Role role) {
  switch (role) {
    case Role::kRobot:
      return "robot";
    case Role::kViewer:
      return "viewer";
    case Role::kTrainer:
      return "trainer";
    case Role::kAdmin:
      break;
  }
  return "admin";
}

absl::StatusOr<Role> ParseRole(absl::string_view name) {
  for (const Role role :
       {Role::kRobot, Role::kViewer, Role::kTrainer, Role::kAdmin}) {
    if (name == RoleName(role)) return role;
  }
  return InvalidConfig("the role", Quoted(name),
                       "robot, viewer, trainer or admin");
}

}  // namespace tactus::internal

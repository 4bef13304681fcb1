// What the examples of public headers need around them. They only have to
// compile. The build takes each .inc from the comment of the header it names.
#include <string>

#include "core/access/access_table.h"
#include "core/access/role.h"
#include "core/base/status_macros.h"

namespace tactus::internal::examples {

void Print(absl::string_view text);
void Use(const std::string& name);

static absl::Status RoleExample() {
#include "core/access/role.h.inc"
  return absl::OkStatus();
}

static absl::Status AccessTableExample(absl::string_view text,
                                       absl::string_view token) {
#include "core/access/access_table.h.inc"
  return absl::OkStatus();
}

}  // namespace tactus::internal::examples

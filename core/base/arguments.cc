#include "core/base/arguments.h"

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace tactus::internal {

absl::Status CheckArguments(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    if (!IsUtf8(argv[i])) {
      return InvalidConfig(absl::StrCat("argument ", i),
                           absl::StrCat("\"", argv[i], "\""), "UTF-8");
    }
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal

#include "tactus/status.h"

#include "core/base/errors.h"

namespace tactus {

std::string ReasonOf(const absl::Status& status) {
  return internal::ReasonOf(status);
}

}  // namespace tactus

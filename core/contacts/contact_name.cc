#include "absl/strings/str_cat.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal {

std::string ContactName(const LabelledContact& contact) {
  const std::string& name = TrialName(contact.id, contact.source);
  if (!contact.touch) return name;
  return absl::StrCat(name, "/", TouchName(*contact.touch));
}

}  // namespace tactus::internal

#include "core/contacts/copies.h"

#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/data/frame_fingerprint.h"

namespace tactus::internal {

std::vector<int> FirstOfEqual(
    const std::vector<const LabelledContact*>& contacts) {
  std::map<absl::string_view, int> seen;
  std::vector<int> first(contacts.size());
  for (int i = 0; i < static_cast<int>(contacts.size()); ++i) {
    const std::string& fingerprint = contacts[i]->fingerprint;
    first[i] = IdentifiesRecording(fingerprint)
                   ? seen.emplace(fingerprint, i).first->second
                   : i;
  }
  return first;
}

std::vector<Copy> FindCopies(
    const std::vector<const LabelledContact*>& contacts) {
  std::vector<Copy> copies;
  const std::vector<int> first = FirstOfEqual(contacts);
  for (int i = 0; i < static_cast<int>(contacts.size()); ++i) {
    if (first[i] != i) copies.push_back({i, first[i]});
  }
  return copies;
}

std::string CopyText(const std::vector<const LabelledContact*>& contacts,
                     const Copy& copy) {
  const LabelledContact& contact = *contacts[copy.contact];
  const LabelledContact& first = *contacts[copy.first];
  return absl::StrCat(ContactName(contact), " (", contact.label,
                      ") has the frames of ", ContactName(first), " (",
                      first.label, ")");
}

}  // namespace tactus::internal

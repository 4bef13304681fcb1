// File: contact_index.h
//
// ContactIndex: what lists say of the contacts of a log, in memory.
//
//   index.Add(17, stored);
//   TACTUS_ASSIGN_OR_RETURN(const ContactIndex::Found found,
//                           index.Search(request));
//
// Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "server/contact_log/contact_name.h"
#include "tactus/v1/contact_log.pb.h"
#include "tactus/v1/storage.pb.h"

namespace tactus::internal::server {

class ContactIndex {
 public:
  struct Found {
    // A page.
    std::vector<v1::LoggedContact> contacts;
    std::string next_page_token;
    uint32_t matching = 0;
  };

  // The contacts of a record; their pictures are left out.
  void Add(uint64_t record, const v1::StoredContacts& stored);
  // Labels of contacts that are here still.
  void AddLabels(const v1::StoredLabels& labels);
  // Forgets the records before `record`.
  void ForgetBefore(uint64_t record);

  size_t size() const { return contacts_.size(); }
  // Null if there is none.
  const v1::LoggedContact* Find(const ContactName& name) const;
  // The contacts of a record, by place.
  std::vector<v1::LoggedContact> OfRecord(uint64_t record) const;
  // INVALID_CONFIG, INVALID_NAME, CONTACT_NOT_FOUND for one of `names`.
  absl::StatusOr<Found> Search(const v1::ListContactsRequest& request) const;

 private:
  std::map<ContactName, v1::LoggedContact> contacts_;
};

// CONTACT_NOT_FOUND.
absl::Status NoSuchContact(const std::string& name);

}  // namespace tactus::internal::server

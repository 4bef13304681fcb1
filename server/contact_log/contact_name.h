// File: contact_name.h
//
// ContactName: what a contact of the log is called. "contacts/17" is the first
// contact of record 17, and "contacts/17-2" the second.
//
//   TACTUS_ASSIGN_OR_RETURN(const ContactName name, ParseContactName(text));
//   Print(name.ToString());
//
// Thread-safe: plain data and a free function.
#pragma once

#include <compare>
#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal::server {

struct ContactName {
  uint64_t record = 0;
  // Its place among the contacts of the record, from 0.
  uint32_t place = 0;

  std::string ToString() const;
  auto operator<=>(const ContactName&) const = default;
};

// INVALID_NAME.
absl::StatusOr<ContactName> ParseContactName(absl::string_view text);

}  // namespace tactus::internal::server

// File: event_line.h
//
// One event of a contact as a line for people, or as JSON.
//
//   EventLine(event, 1540, started, false);  // "contact 2  1,540 ms: slipping"
//
// As JSON, the line is an object with `contact`, `ms`, `event`, and of those
// that are about a question `question` and `value`, of those about another
// contact `other`. Thread-safe: a free function without state.
#pragma once

#include <cstdint>
#include <string>

#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

// `event` happened `ms` after the contact's onset.
std::string EventLine(const v1::ContactEvent& event, int64_t ms,
                      const v1::StreamStarted& started, bool json);

}  // namespace tactus::internal::client

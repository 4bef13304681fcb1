// File: answers.h
//
// What a program asks of an Answer: its most important contact, the most
// probable class, and the class that all decisions together name.
//
//   if (const v1::Contact* contact = MainContact(answer)) {
//     Show(started.class_names(BestClass(*contact)));
//   }
//
// Answers are those that a stream returned, so their sizes are right
// (response_checker.h). Thread-safe: free functions without state.
#pragma once

#include <cstdint>
#include <optional>

#include "tactus/v1/contact.pb.h"

namespace tactus::internal::client {

// The contact with the largest area; null if there is none. Refers to `answer`.
const v1::Contact* MainContact(const v1::Answer& answer);

// True unless the contact has ended.
bool IsOpen(const v1::Contact& contact);

// Index of the most probable class.
int BestClass(const v1::Contact& contact);

// The one class whose values have all been decided.
struct DecidedClass {
  int class_index = 0;
  // From onset to the last of these decisions, or of their changes.
  int64_t time_since_onset_ns = 0;
};

// Nothing if a question is undecided, or if not exactly one class fits.
std::optional<DecidedClass> DecidedClassOf(const v1::StreamStarted& started,
                                           const v1::Contact& contact);

}  // namespace tactus::internal::client

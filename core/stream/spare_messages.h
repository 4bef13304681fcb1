// File: spare_messages.h
//
// SpareMessages: keeps the messages that an answer does not need now for the
// next one that does. Protobuf would delete them, and allocate others.
//
//   SpareMessages<v1::Contact> spare;
//   spare.Resize(2, answer->mutable_contacts());  // with old values
//
// Grows to what was needed at the most. Not thread-safe.
#pragma once

#include <memory>
#include <vector>

#include "google/protobuf/repeated_field.h"

namespace tactus::internal {

template <typename Message>
class SpareMessages {
 public:
  // Makes `field` as long as `size`. New elements hold old values.
  void Resize(int size, google::protobuf::RepeatedPtrField<Message>* field) {
    // Once, for more than most answers need.
    if (field->Capacity() == 0) field->Reserve(kRoom);
    while (field->size() > size) Keep(field->ReleaseLast());
    while (field->size() < size) field->AddAllocated(Take());
  }

  // Takes over a message.
  void Keep(Message* message) { kept_.emplace_back(message); }

  // The caller owns the message, which holds old values.
  Message* Take() {
    if (kept_.empty()) return new Message;
    Message* message = kept_.back().release();
    kept_.pop_back();
    return message;
  }

 private:
  static constexpr int kRoom = 8;

  std::vector<std::unique_ptr<Message>> kept_;
};

}  // namespace tactus::internal

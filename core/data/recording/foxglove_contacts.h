// File: foxglove_contacts.h
//
// FoxgloveContacts: the contacts of an answer as outlines over the pictures of
// FoxgloveImage, of the schema foxglove.ImageAnnotations. Each has its number
// and what is decided of it, as text. A place is measured in taxels from the
// picture's upper left corner.
//
//   FoxgloveContacts contacts(layout, started.questions());
//   const McapSchema schema = FoxgloveContacts::Schema();
//   const std::string bytes = contacts.Encode(answer);
//
// Not thread-safe.
#pragma once

#include <string>
#include <utility>

#include "core/files/mcap/mcap_records.h"
#include "core/skin/layout.h"
#include "tactus/v1/contact.pb.h"

namespace tactus::internal {

class FoxgloveContacts {
 public:
  using Questions = google::protobuf::RepeatedPtrField<v1::Question>;

  // Skin and questions are those of the stream whose answers are shown.
  FoxgloveContacts(SkinLayout layout, Questions questions)
      : layout_(std::move(layout)), questions_(std::move(questions)) {}

  static McapSchema Schema();

  // A serialised foxglove.ImageAnnotations. Contacts that touch nothing now, or
  // whose taxels the answer does not have, are left out.
  std::string Encode(const v1::Answer& answer) const;

 private:
  SkinLayout layout_;
  Questions questions_;
};

}  // namespace tactus::internal

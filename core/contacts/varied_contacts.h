// File: varied_contacts.h
//
// VariedContacts: labelled contacts and their copies (variation.h), made one at
// a time when they are needed, so that copies take no memory.
//
//   const VariedContacts varied(contacts, {.copies = 4, .pace = 3}, seed);
//   LabelledContact made;
//   for (size_t i = 0; i < varied.size(); ++i) {
//     MakeSequence(varied.Get(i, made), inputs, steps);
//   }
//
// Refers to the contacts, which must outlive it. Thread-safe after
// MeasureNoise(), with one `made` per thread.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "core/base/work.h"
#include "core/contacts/labelled_contact.h"
#include "core/contacts/variation.h"

namespace tactus::internal {

// How many copies of each contact are drawn, and from which ranges. The factors
// are uniform in their logarithm: pace from 1 / pace to pace, load from
// 1 / load to 1, and in every second copy stiffness from 1 / stiffness to
// stiffness. A class is soft if all objects of another class are stiffer; its
// copies get no stiffer than its stiffest object. A class is hard if all
// objects of another class are softer; its copies get no softer than its
// softest object. Other classes keep their stiffness, and so do all if the
// stiffness of any contact is unknown.
struct VariationRange {
  int copies = 0;
  double pace = 1;       // >= 1
  double load = 1;       // >= 1
  double stiffness = 1;  // >= 1
};

class VariedContacts {
 public:
  // The same contacts, range and seed give the same copies.
  explicit VariedContacts(std::vector<const LabelledContact*> contacts,
                          const VariationRange& range = {}, uint64_t seed = 0);

  // Measures the noise of each contact, which the copies need. Otherwise it is
  // measured for each copy, which is slower.
  void MeasureNoise(const ParallelFor& parallel = RunSerially);

  // The contacts, then the first copy of each, then the second of each.
  size_t size() const { return contacts_.size() * (1 + range_.copies); }
  // The contact that number `index` is or is a copy of.
  const LabelledContact& Original(size_t index) const {
    return *contacts_[index % contacts_.size()];
  }
  const std::vector<const LabelledContact*>& originals() const {
    return contacts_;
  }
  // Returns number `index`. Writes it to `made` if it is a copy.
  const LabelledContact& Get(size_t index, LabelledContact& made) const;

 private:
  // A range of stiffness, N/m.
  struct Span {
    double min = 0;
    double max = 0;
  };

  static std::map<std::string, Span> SpansOf(
      const std::vector<const LabelledContact*>& contacts);

  std::vector<const LabelledContact*> contacts_;
  VariationRange range_;
  uint64_t seed_;
  // The stiffnesses that keep a contact in its class, by class. Classes without
  // an entry keep their stiffness.
  std::map<std::string, Span> spans_;
  std::vector<ContactNoise> noise_;  // empty, or one per contact
};

}  // namespace tactus::internal

// File: pattern_contacts.h
//
// Made-up contacts that only the pattern of the load tells apart. Test-only.
//
//   const auto contacts = ContactsByPattern();
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/contacts/labelled_contact.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal::testing {

// Contacts of three classes that differ in the shares of the load on two of
// twelve taxels; the others only vary.
inline std::vector<LabelledContact> ContactsByPattern() {
  constexpr double kShift[][2] = {{0.6, 0}, {-0.6, 0}, {0, 0.6}};
  Random random(11);
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 36; ++i) {
    LabelledContact contact;
    contact.id = std::to_string(i);
    contact.label = std::string(1, static_cast<char>('a' + i % 3));
    contact.layout = FlatLayout(3, 4);
    contact.layout.name = "patch";
    contact.with_poses = false;
    for (int n = 0; n < 30; ++n) {
      std::vector<TaxelLoad> loads;
      for (uint32_t t = 0; t < 12; ++t) {
        double root = 3 + 0.5 * random.Gaussian();
        if (t == 4) root += kShift[i % 3][0];
        if (t == 9) root += kShift[i % 3][1];
        loads.push_back({t, static_cast<float>(std::max(root, 0.01))});
      }
      ContactFrame frame = {IdealSample({1, 1e-4, 0})};
      frame.sample.loads = loads;
      contact.frames.push_back(frame);
    }
    contacts.push_back(std::move(contact));
  }
  return contacts;
}

}  // namespace tactus::internal::testing

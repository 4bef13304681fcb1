// File: synthetic_contacts.h
//
// Labelled contacts with known answers: force and motion differ from class to
// class, and the gain differs from condition to condition. Seeded.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/base/random.h"
#include "core/contacts/labelled_contact.h"

namespace tactus::internal::testing {

// `per_class` contacts of each of HU, HM, SU, SM in two conditions and three
// materials, `frames` frames at 100 Hz. Larger `noise` makes classes overlap.
inline std::vector<LabelledContact> SyntheticContacts(int per_class, int frames,
                                                      double noise,
                                                      uint64_t seed) {
  const char* labels[] = {"HU", "HM", "SU", "SM"};
  const double force[] = {4, 3, 0.8, 0.5};
  const double motion[] = {0.0005, 0.012, 0.006, 0.018};
  std::vector<LabelledContact> contacts;
  for (int i = 0; i < 4 * per_class; ++i) {
    const int k = i % 4;
    const int n = i / 4;
    Random random = Random::ForStream(seed, i);
    LabelledContact contact;
    contact.id = std::to_string(i);
    contact.label = labels[k];
    contact.condition = n % 2 == 0 ? "slow" : "fast";
    contact.material = "m" + std::to_string(n % 3);
    const double gain =
        (n % 2 == 0 ? 1 : 1.3) * std::exp(noise * random.Gaussian());
    for (int t = 1; t <= frames; ++t) {
      const double ramp = std::min(1.0, 3.0 * t / frames);
      contact.frames.push_back(
          {IdealSample({gain * force[k] * ramp + 0.02 * random.Gaussian(),
                        81e-6 * static_cast<double>(1 + random.Index(6)),
                        gain * motion[k] * ramp + 5e-5 * random.Gaussian()})});
    }
    contacts.push_back(std::move(contact));
  }
  return contacts;
}

inline std::vector<const LabelledContact*> PointersTo(
    const std::vector<LabelledContact>& contacts) {
  std::vector<const LabelledContact*> pointers;
  for (const LabelledContact& contact : contacts) pointers.push_back(&contact);
  return pointers;
}

}  // namespace tactus::internal::testing

#include "core/contacts/varied_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace tactus::internal {
namespace {

// Draws a factor on the stiffness, uniform in its logarithm, from the part of
// 1 / range to range that keeps the stiffness between `min` and `max`.
double DrawStiffness(double stiffness, double min, double max, double range,
                     Random& random) {
  const double low = std::max(1 / range, min / stiffness);
  const double high = std::min(range, max / stiffness);
  return low * std::pow(high / low, random.Uniform());
}

}  // namespace

// Soft and hard classes are those of VariationRange; empty if a stiffness is
// unknown.
std::map<std::string, VariedContacts::Span> VariedContacts::SpansOf(
    const std::vector<const LabelledContact*>& contacts) {
  std::map<std::string, Span> seen;
  for (const LabelledContact* contact : contacts) {
    const double k = contact->stiffness;
    if (k <= 0) return {};
    Span& span = seen.try_emplace(contact->label, Span{k, k}).first->second;
    span.min = std::min(span.min, k);
    span.max = std::max(span.max, k);
  }
  std::map<std::string, Span> spans;
  for (const auto& [label, own] : seen) {
    bool soft = false;
    bool hard = false;
    for (const auto& [other, others] : seen) {
      soft |= own.max < others.min;
      hard |= own.min > others.max;
    }
    if (soft == hard) continue;
    spans[label] = soft
                       ? Span{0, own.max}
                       : Span{own.min, std::numeric_limits<double>::infinity()};
  }
  return spans;
}

VariedContacts::VariedContacts(std::vector<const LabelledContact*> contacts,
                               const VariationRange& range, uint64_t seed)
    : contacts_(std::move(contacts)), range_(range), seed_(seed) {
  if (range_.copies > 0) spans_ = SpansOf(contacts_);
}

void VariedContacts::MeasureNoise(const ParallelFor& parallel) {
  if (range_.copies == 0 || !noise_.empty()) return;
  noise_.resize(contacts_.size());
  parallel(static_cast<int>(contacts_.size()),
           [&](int i) { noise_[i] = NoiseIn(*contacts_[i]); });
}

const LabelledContact& VariedContacts::Get(size_t index,
                                           LabelledContact& made) const {
  const LabelledContact& contact = Original(index);
  if (index < contacts_.size()) return contact;
  const size_t drawn = index - contacts_.size();
  const size_t copy = drawn / contacts_.size();
  Random random = Random::ForStream(seed_, drawn);
  Variation variation;
  variation.pace = std::pow(range_.pace, random.Uniform(-1, 1));
  variation.load = std::pow(range_.load, random.Uniform(-1, 0));
  const auto span = spans_.find(contact.label);
  if (copy % 2 == 1 && range_.stiffness > 1 && span != spans_.end()) {
    variation.stiffness =
        DrawStiffness(contact.stiffness, span->second.min, span->second.max,
                      range_.stiffness, random);
  }
  const size_t original = index % contacts_.size();
  Vary(contact, noise_.empty() ? NoiseIn(contact) : noise_[original], variation,
       random, made);
  return made;
}

}  // namespace tactus::internal

// File: contact_phase.h
//
// The phases of a contact. In each of them the motion is a linear differential
// equation; an event ends it:
//
//   kStuck    touching, object at rest    slip -> kSliding, lost -> kApart
//   kSliding  touching, object slides     stop -> kStuck, lost -> kCoasting
//   kCoasting apart, object slides        stop -> kApart, made -> kSliding
//   kApart    apart, object at rest       made -> kStuck
//
//   const bool touching = Touching(phase);
//   if (touching && !Sliding(phase)) return;  // kStuck
//
// The force only pushes (no adhesion), so the object never moves back.
// Thread-safe: functions without state.
#pragma once

namespace tactus::internal {

enum class ContactPhase { kStuck, kSliding, kCoasting, kApart };

inline bool Touching(ContactPhase phase) {
  return phase == ContactPhase::kStuck || phase == ContactPhase::kSliding;
}

inline bool Sliding(ContactPhase phase) {
  return phase == ContactPhase::kSliding || phase == ContactPhase::kCoasting;
}

}  // namespace tactus::internal

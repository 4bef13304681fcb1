// File: course_watch.h
//
// CourseWatch: tells when a contact leaves its course, as when the object
// slips, is pushed on or gives way. Force, area, motion and shear are each
// predicted from the frames before by double exponential smoothing (Holt,
// 1957). While the contact keeps its course, the errors of a prediction are
// noise; when it leaves it, they keep to one side, and their cumulative sum
// grows (Page, 1954). The noise is estimated as well, so that every skin and
// unit is watched alike.
//
//   CourseWatch watch;
//   for (const ContactSample& sample : contact) {
//     if (watch.Step(sample)) Look(sample);
//   }
//
// Owns a few numbers; nothing allocates. Not thread-safe: one per contact.
#pragma once

#include <array>

#include "core/features/feature.h"

namespace tactus::internal {

class CourseWatch {
 public:
  // Starts a new contact.
  void Reset();

  // Takes the features of a frame. Returns true if the contact has left the
  // course that it had since the last call of Restart().
  bool Step(const ContactSample& sample);

  // The course of the last frames is the contact's now.
  void Restart();

 private:
  struct Channel {
    double level = 0;
    double slope = 0;
    double variance = 0;
    // Sums of errors above and below, in standard deviations.
    double above = 0;
    double below = 0;
  };

  bool Step(double value, Channel& channel) const;

  // Net force, area, motion, shear.
  std::array<Channel, 4> channels_;
  int frames_ = 0;
};

}  // namespace tactus::internal

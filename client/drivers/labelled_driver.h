// File: labelled_driver.h
//
// LabelledDriver: a driver whose frames belong to trials that have a label,
// such as those of a simulator or a recording.
//
//   while (*driver.Read(frame) == ReadResult::kFrame) Use(frame);
//   driver.trial().label;  // "HU"
//
// Not thread-safe: each driver belongs to one thread.
#pragma once

#include <cstddef>

#include "client/drivers/skin_driver.h"
#include "core/data/trial.h"

namespace tactus::internal::client {

class LabelledDriver : public SkinDriver {
 public:
  // The trial being played: its id, label and so on, perhaps without frames;
  // the last one after its end.
  virtual const Trial& trial() const = 0;
  // Its place in the whole list.
  virtual size_t trial_index() const = 0;
};

}  // namespace tactus::internal::client

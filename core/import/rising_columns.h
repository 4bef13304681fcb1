// File: rising_columns.h
//
// Columns of taxels that rise in every frame, as times and counters do and the
// load on a taxel does not.
//
//   RisingColumns rising;
//   for (const ArrayFile& file : files) {
//     rising.Add(FindRising(file, columns), file.array.shape[0]);
//   }
//   rising.Always();
//
// FindRising is thread-safe; an object is not.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "core/files/array_file.h"

namespace tactus::internal {

struct RisingColumn {
  size_t column = 0;
  // As errors name it.
  std::string name;
  // All steps are alike, as those of a clock or a counter.
  bool steady = false;
};

// Those of `columns` that rise from each frame of `file` to the next, or do so
// in steady steps and begin again, as a counter of 8 bits does; none if there
// are fewer than 8 frames.
std::vector<RisingColumn> FindRising(const ArrayFile& file,
                                     const std::vector<size_t>& columns);

// Which columns rise in all files of a set.
class RisingColumns {
 public:
  // The rising columns of one file of `frames` frames.
  void Add(const std::vector<RisingColumn>& rising, size_t frames);
  // Those that rise in every file; `steady` if they are so in every file.
  std::vector<RisingColumn> Always() const;

 private:
  struct Seen {
    RisingColumn column;
    size_t files = 0;
  };
  std::map<std::string, Seen> seen_;
  size_t files_ = 0;
};

}  // namespace tactus::internal

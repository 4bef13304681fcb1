// File: import.h
//
// Recordings of other programs as trials, one at a time.
//
//   TACTUS_ASSIGN_OR_RETURN(auto writer, TrialFileWriter::Create(out, {}));
//   TACTUS_RETURN_IF_ERROR(ImportTrials(
//       dir, [&](Trial trial) { return writer.Append(trial); }).status());
//
// `path` is one of
//   - a folder with a skin.json, or that file: recordings of any skin
//     (import_skin_folder.h);
//   - a trial file (.h5), for trials that get another skin;
//   - a recording of tactus-stream (.mcap), whose contacts become trials
//     (import_recording.h);
//   - a bag of ROS 2, one trial (ros2/ros2_bag.h), or with a table or a pattern
//     of file names a folder of bags;
//   - a CSV file, one trial, header exactly `time,force,area,motion` (s, N or
//     counts, m^2, m), before it optional lines `# key=value` with the keys
//     source, label, condition, object, material, stiffness, velocity,
//     sample_rate_hz and unit;
//   - a .npz file, one trial (trial_npz.h);
//   - a folder of such CSV and .npz files, taken in the order of their names.
// docs/formats.md states how each column is used. Not thread-safe, like HDF5
// itself.
#pragma once

#include <functional>
#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"

namespace tactus::internal {

using TrialSink = absl::FunctionRef<absl::Status(Trial)>;

struct ImportOptions {
  // The skin.json of a folder that has none, or of a trial file; empty: the
  // folder's own.
  std::string skin = {};
  // The same of a bag of ROS 2, or of a folder of bags: `dataset` is the topic.
  std::string mapping = {};
  // The table of a folder; empty: as the skin.json says, beside it or in the
  // folder. Or of a recording's contacts.
  std::string table = {};
  // A pattern that takes fields from the names of a folder's files
  // (file_names.h), instead of that of the skin.json.
  std::string file_names = {};
  // Those of trials that have none; empty: as the source says. A contact that
  // the table of a recording leaves out stays out.
  std::string label = {};
  std::string condition = {};
  // If set, gets texts for people about what was left out.
  std::function<void(const std::string&)> remark = {};
};

// Hands each trial to `sink`, with the name of its recording as its source and
// an id that no other one has (trial_id.h); stops at the first error, the
// sink's included. Returns how many there were. IO or TRIAL_FILE_INVALID with
// file and line; INVALID_CONFIG for options that the source does not take.
absl::StatusOr<size_t> ImportTrials(const std::string& path, TrialSink sink,
                                    const ImportOptions& options = {});

// Gives a trial without a label, or without a condition, that of the options.
void NameUnnamed(const ImportOptions& options, Trial& trial);

// One trial of three signals; `number` becomes its id, the file's name its
// source.
absl::StatusOr<Trial> ImportSignalsCsv(const std::string& path, size_t number);

}  // namespace tactus::internal

// File: import.h
//
// Recordings of other programs as trials, one at a time.
//
//   TACTUS_ASSIGN_OR_RETURN(auto writer, TrialFileWriter::Create(out, {}));
//   TACTUS_RETURN_IF_ERROR(ImportTrials(
//       dir, [&](Trial trial) { return writer.Append(trial); }).status());
//
// `path` is one of
//   - a folder with index.csv and trials/NNNN.npy, whose kind follows from the
//     columns of index.csv: "vitac384" has hardness and motion, "icub_slide20"
//     has material_by_index;
//   - a CSV file, one trial, header exactly `time,force,area,motion` (s, N or
//     counts, m^2, m), before it optional lines `# key=value` with the keys
//     label, condition, object, material, stiffness, velocity, sample_rate_hz
//     and unit;
//   - a .npz file, one trial (trial_npz.h);
//   - a folder of such CSV and .npz files, taken in the order of their names.
// docs/formats.md states how each column is used. Thread-safe: free
// functions without state.
#pragma once

#include <string>

#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/csv.h"
#include "core/data/trial.h"

namespace tactus {

using TrialSink = absl::FunctionRef<absl::Status(Trial)>;

// Hands each trial to `sink`; stops at the first error, the sink's included.
// Returns how many there were. IO or TRIAL_FILE_INVALID with file and line.
absl::StatusOr<size_t> ImportTrials(const std::string& path, TrialSink sink);

// The parts, one per format. `table` is the folder's index.csv.
absl::StatusOr<size_t> ImportVitac(const std::string& folder,
                                   const CsvTable& table, TrialSink sink);
absl::StatusOr<size_t> ImportIcub(const std::string& folder,
                                  const CsvTable& table, TrialSink sink);
// One trial of three signals; `number` becomes its id.
absl::StatusOr<Trial> ImportSignalsCsv(const std::string& path, size_t number);

}  // namespace tactus

// File: trial_file.h
//
// Reads and writes trial files: HDF5, format "tactus-trials", version 1.
// docs/formats.md describes each dataset. Trials with a skin keep it.
//
//   TACTUS_ASSIGN_OR_RETURN(auto writer, TrialFileWriter::Create(path, {}));
//   TACTUS_RETURN_IF_ERROR(writer.Append(trial));
//   TACTUS_RETURN_IF_ERROR(writer.Close());
//
//   TACTUS_ASSIGN_OR_RETURN(auto reader, TrialFileReader::Open(path));
//   for (size_t i = 0; i < reader.size(); ++i) {
//     TACTUS_ASSIGN_OR_RETURN(Trial trial, reader.Read(i));
//   }
//
// Each object owns its file. Not thread-safe: the serial HDF5 library may be
// used by one thread at a time in the whole process.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "core/data/trial.h"

namespace tactus::internal {

struct TrialFileOptions {
  // False: an existing file of that name is an error.
  bool overwrite = false;
};

// Writes beside the target and renames at Close(), so that nobody ever sees
// half a file. Without a successful Close() the target stays as it was.
class TrialFileWriter {
 public:
  static absl::StatusOr<TrialFileWriter> Create(
      const std::string& path, const TrialFileOptions& options);
  TrialFileWriter(TrialFileWriter&&) noexcept;
  TrialFileWriter& operator=(TrialFileWriter&&) noexcept;
  ~TrialFileWriter();

  // Adds a trial. An empty id becomes the next free six-digit number. A
  // trial that Validate() refuses leaves the file as it was; after an IO
  // error every further call fails.
  absl::Status Append(const Trial& trial);

  // Makes the file durable and visible under its name. Once.
  absl::Status Close();

 private:
  struct State;
  explicit TrialFileWriter(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

// Reads one trial at a time, in the order of their ids. Whatever the file
// holds, the outcome is a valid trial or TRIAL_FILE_INVALID.
class TrialFileReader {
 public:
  // Opens the file in a child process first (core/files/hdf5_probe.h), and
  // unless TrialFileWriter made it, reads all of it there: such a file is
  // refused as a whole if one of its trials cannot be read.
  static absl::StatusOr<TrialFileReader> Open(const std::string& path);
  TrialFileReader(TrialFileReader&&) noexcept;
  TrialFileReader& operator=(TrialFileReader&&) noexcept;
  ~TrialFileReader();

  size_t size() const;
  // The trial's group name; `index` < size().
  const std::string& id(size_t index) const;
  // An index beyond the last trial is TRIAL_FILE_INVALID.
  absl::StatusOr<Trial> Read(size_t index) const;
  // Everything at once, for small files.
  absl::StatusOr<std::vector<Trial>> ReadAll() const;

 private:
  struct State;
  explicit TrialFileReader(std::unique_ptr<State> state);
  static absl::StatusOr<TrialFileReader> OpenUnprobed(const std::string& path);
  std::unique_ptr<State> state_;
};

}  // namespace tactus::internal

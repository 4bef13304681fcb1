// File: hdf5_read.h
//
// Checked reading of HDF5 attributes and datasets, of trials and of models:
// nothing that is read is trusted, nothing huge is allocated on its word.
//
//   const Hdf5Complaint complain(path, "000007");
//   double rate = 100;
//   TACTUS_RETURN_IF_ERROR(ReadNumber(group, "sample_rate_hz", complain,
//   &rate));
//
// All errors are TRIAL_FILE_INVALID and name the part. Not thread-safe, like
// HDF5 itself.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "core/base/errors.h"
#include "core/files/hdf5_handle.h"

namespace tactus::internal {

// Makes errors that name file, trial and part.
class Hdf5Complaint {
 public:
  Hdf5Complaint(absl::string_view path, absl::string_view trial)
      : path_(path), trial_(trial) {}

  template <typename... Parts>
  absl::Status operator()(absl::string_view part, const Parts&... text) const {
    return TrialFileInvalid(
        path_, absl::StrCat(trial_.empty() ? "" : "trial ", trial_,
                            trial_.empty() ? "" : ": ", part, ": ", text...));
  }
  absl::Status Hdf5(absl::string_view part) const {
    return (*this)(part, "cannot be read: ", Hdf5LastError());
  }

 private:
  absl::string_view path_;
  absl::string_view trial_;
};

// A dataset that is stored in this very file and whose shape is known.
struct Hdf5Dataset {
  Hdf5Handle id;
  Hdf5Handle type;
  std::vector<hsize_t> dims;
};

// Opens an attribute that must hold one value.
absl::Status OpenScalarAttribute(hid_t object, const char* name,
                                 const Hdf5Complaint& complain, Hdf5Handle* out,
                                 Hdf5Handle* type);

// Text of fixed or variable length. Leaves `value` as it is if the attribute
// is absent.
absl::Status ReadText(hid_t object, const char* name,
                      const Hdf5Complaint& complain, std::string* value);

// An attribute with a list of texts. Leaves `values` as it is if the attribute
// is absent.
absl::Status ReadTextList(hid_t object, const char* name,
                          const Hdf5Complaint& complain,
                          std::vector<std::string>* values);

// The names in a group, in alphabetical order.
absl::StatusOr<std::vector<std::string>> ListNames(
    hid_t group, const Hdf5Complaint& complain);

// Accepts integers too. Leaves `value` as it is if the attribute is absent.
absl::Status ReadNumber(hid_t object, const char* name,
                        const Hdf5Complaint& complain, double* value);

// Soft and external links are not followed: a trial file holds its own data.
absl::StatusOr<bool> HasHardLink(hid_t group, const char* name,
                                 const Hdf5Complaint& complain);

// Opens a dataset that HasHardLink() has found.
absl::Status OpenDataset(hid_t group, const char* name,
                         const Hdf5Complaint& complain, Hdf5Dataset* out);

// Refuses a dataset whose claimed shape is not `want` (0 = any) or could not
// be in the file, so that a damaged size never leads to a huge allocation.
absl::Status CheckShape(const Hdf5Dataset& dataset, const char* name,
                        const std::vector<hsize_t>& want, size_t value_bytes,
                        const Hdf5Complaint& complain);

// Reads all of a dataset into `out`, which has room for it.
absl::Status ReadValues(const Hdf5Dataset& dataset, const char* name,
                        hid_t memory_type, const Hdf5Complaint& complain,
                        void* out);

// Reads a [rows x columns] array of float32 or float64, row-major; `rows` 0
// takes any, `columns` 0 means a plain vector. Absent: leaves `out` empty.
absl::Status ReadDoubles(hid_t group, const char* name, hsize_t rows,
                         hsize_t columns, const Hdf5Complaint& complain,
                         std::vector<double>* out);

}  // namespace tactus::internal

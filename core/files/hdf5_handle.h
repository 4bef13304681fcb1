// File: hdf5_handle.h
//
// Small owning wrappers round the HDF5 C library, for the trial files only.
//
//   const Hdf5Quiet quiet;
//   Hdf5Handle file(H5Fopen(path, H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose);
//   if (!file.ok()) return TrialFileInvalid(path, Hdf5LastError());
//
// Not thread-safe: Debian's serial HDF5 may be used by one thread at a time
// in the whole process.
#pragma once

#include <hdf5.h>

#include <string>
#include <utility>

namespace tactus::internal {

// Owns one HDF5 identifier and closes it.
class Hdf5Handle {
 public:
  using Closer = herr_t (*)(hid_t);

  Hdf5Handle() = default;
  Hdf5Handle(hid_t id, Closer closer) : id_(id), closer_(closer) {}
  Hdf5Handle(Hdf5Handle&& other) noexcept { *this = std::move(other); }
  Hdf5Handle& operator=(Hdf5Handle&& other) noexcept {
    std::swap(id_, other.id_);
    std::swap(closer_, other.closer_);
    return *this;
  }
  ~Hdf5Handle() { Close(); }

  bool ok() const { return id_ >= 0; }
  hid_t get() const { return id_; }
  // False if HDF5 reported an error, e.g. that the disk is full.
  bool Close();

 private:
  hid_t id_ = H5I_INVALID_HID;
  Closer closer_ = nullptr;
};

// While it lives HDF5 prints nothing; errors are still recorded.
class Hdf5Quiet {
 public:
  Hdf5Quiet();
  ~Hdf5Quiet();
  Hdf5Quiet(const Hdf5Quiet&) = delete;
  Hdf5Quiet& operator=(const Hdf5Quiet&) = delete;

 private:
  H5E_auto2_t function_ = nullptr;
  void* data_ = nullptr;
};

// The root cause HDF5 recorded for its last failed call.
std::string Hdf5LastError();

}  // namespace tactus::internal

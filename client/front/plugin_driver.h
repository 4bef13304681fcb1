// File: plugin_driver.h
//
// Loads a driver from a shared library (tactus/driver.h).
//
//   TACTUS_ASSIGN_OR_RETURN(const std::unique_ptr<Driver> driver,
//                           LoadDriver("./my_skin.so", options));
//
// Thread-safe. The library stays loaded until the program ends.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "tactus/driver.h"

namespace tactus::internal::client {

// True if the name of a driver is that of a library.
bool IsDriverLibrary(const std::string& driver);

// INVALID_CONFIG if there is no such library, it is for another release, or it
// makes no driver; else the errors of the library's own function.
absl::StatusOr<std::unique_ptr<Driver>> LoadDriver(
    const std::string& path, const DriverOptions& options);

}  // namespace tactus::internal::client

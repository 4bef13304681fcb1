// File: plugin_driver.h
//
// Loads a driver from a shared library (client/drivers/driver_plugin.h).
//
//   TACTUS_ASSIGN_OR_RETURN(const auto driver,
//                           LoadDriver("./my_skin.so", options));
//
// Thread-safe. The library stays loaded until the program ends.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "client/drivers/driver_plugin.h"

namespace tactus::client {

// True if --driver names a library.
bool IsDriverLibrary(const std::string& driver);

// INVALID_CONFIG if there is no such library, it is for another release, or it
// makes no driver; else the errors of the library's own function.
absl::StatusOr<std::unique_ptr<SkinDriver>> LoadDriver(
    const std::string& path, const DriverOptions& options);

}  // namespace tactus::client

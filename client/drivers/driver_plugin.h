// File: driver_plugin.h
//
// Makes a skin driver loadable from a shared library. Users name the library
// with `--driver=./my_skin.so` of `tactus-stream` and `trainctl record`:
//
//   TACTUS_SKIN_DRIVER([](const DriverOptions& options) {
//     return std::make_unique<MySkin>(options);
//   })
//
// Write it at namespace scope, once in a library. The library needs the headers
// of Tactus::client and links none of its libraries. It must be built with the
// headers of the program's release and the same compiler, because objects are
// handed over; DriverAbi() is compared before anything is called.
//
// Thread-safe: the function is called once.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "client/drivers/skin_driver.h"

namespace tactus::client {

// What --driver-option=NAME=VALUE gave.
using DriverOptions = std::map<std::string, std::string>;

// Changes with each change of SkinDriver, SkinInfo or SkinFrame.
inline constexpr int kDriverAbi = 1;

}  // namespace tactus::client

// `make`: DriverOptions -> std::unique_ptr<SkinDriver>, or a StatusOr of it.
#define TACTUS_SKIN_DRIVER(make)                                              \
  extern "C" int tactus_driver_abi() { return ::tactus::client::kDriverAbi; } \
  extern "C" void tactus_make_driver(                                         \
      const ::tactus::client::DriverOptions& options,                         \
      ::absl::StatusOr<std::unique_ptr<::tactus::client::SkinDriver>>*        \
          driver) {                                                           \
    *driver = (make)(options);                                                \
  }

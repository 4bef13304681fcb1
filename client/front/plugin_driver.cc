#include "client/front/plugin_driver.h"

#include <dlfcn.h>

#include <filesystem>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/text.h"

namespace tactus::internal::client {
namespace {

absl::Status NoDriver(const std::string& path, const std::string& is) {
  return InvalidConfig("driver", absl::StrCat(Quoted(path), ", ", is),
                       "a library that is built with TACTUS_DRIVER of "
                       "this release (docs/drivers.md)");
}

}  // namespace

bool IsDriverLibrary(const std::string& driver) {
  return absl::EndsWith(driver, ".so");
}

absl::StatusOr<std::unique_ptr<Driver>> LoadDriver(
    const std::string& path, const DriverOptions& options) {
  // Without a slash dlopen would look among the system's libraries.
  const std::string absolute = std::filesystem::absolute(path);
  void* const library = dlopen(absolute.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) {
    const char* const error = dlerror();
    return NoDriver(path, error == nullptr ? "which cannot be loaded" : error);
  }
  using Abi = int();
  using Make =
      void(const DriverOptions&, absl::StatusOr<std::unique_ptr<Driver>>*);
  auto* const abi = reinterpret_cast<Abi*>(dlsym(library, "tactus_driver_abi"));
  auto* const make =
      reinterpret_cast<Make*>(dlsym(library, "tactus_make_driver"));
  if (abi == nullptr || make == nullptr) {
    return NoDriver(path, "which makes no driver");
  }
  if (abi() != kDriverAbi) {
    return NoDriver(path, absl::StrCat("which is built for version ", abi(),
                                       " of the interface, not ", kDriverAbi));
  }
  absl::StatusOr<std::unique_ptr<Driver>> driver = nullptr;
  make(options, &driver);
  if (driver.ok() && *driver == nullptr) {
    return NoDriver(path, "which makes no driver");
  }
  return driver;
}

}  // namespace tactus::internal::client

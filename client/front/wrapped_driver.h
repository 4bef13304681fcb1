// File: wrapped_driver.h
//
// A public Driver (tactus/driver.h) as the SkinDriver that programs read, and a
// SkinDriver as a public one.
//
//   const std::unique_ptr<SkinDriver> inside = WrapDriver(std::move(driver));
//   const std::unique_ptr<Driver> outside =
//       ExposeDriver(std::make_shared<MyDriver>());
//
// Each keeps the driver that it wraps. Not thread-safe: each belongs to one
// thread.
#pragma once

#include <memory>

#include "client/drivers/skin_driver.h"
#include "tactus/driver.h"

namespace tactus::internal::client {

std::unique_ptr<SkinDriver> WrapDriver(std::unique_ptr<Driver> driver);
std::unique_ptr<Driver> ExposeDriver(std::shared_ptr<SkinDriver> driver);

}  // namespace tactus::internal::client

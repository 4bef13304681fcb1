// File: find_material.h
//
// Looks up one of the paper's materials by name, for tests.
//
//   const Cube cube = {*FindMaterial("steel"), 0.1, Surface::kGlass};
//
// Thread-safe: a function without state. The material lives as long as the
// process.
#pragma once

#include "absl/strings/string_view.h"
#include "core/sim/model/materials.h"

namespace tactus::internal {

// Null if no material has that name.
inline const Material* FindMaterial(absl::string_view name) {
  for (const Material& material : Materials()) {
    if (material.name == name) return &material;
  }
  return nullptr;
}

}  // namespace tactus::internal

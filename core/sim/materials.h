// File: materials.h
//
// The paper's 13 materials (Table "Material Selection for Simulations") and
// cubes made of them. Stateless; thread-safe.
#pragma once

#include <array>
#include <span>

#include "absl/strings/string_view.h"

namespace tactus {

enum class Surface { kWood, kGlass };

struct Friction {
  double mu_static = 0;
  double mu_kinetic = 0;
};

struct Material {
  absl::string_view name;     // "abs-plastic"
  double youngs_modulus = 0;  // Pa
  double density = 0;         // kg/m^3
  Friction wood;
  Friction glass;
  double poisson_ratio = 0;
};

// All 13, in the table's order.
std::span<const Material> Materials();

// Null if there is none of that name.
const Material* FindMaterial(absl::string_view name);

absl::string_view SurfaceName(Surface surface);  // "wood" or "glass"

// A solid cube of edge `edge_m` on a table.
struct Cube {
  Material material;
  double edge_m = 0;
  Surface surface = Surface::kWood;

  double Mass() const;       // kg, eq. 8
  double Stiffness() const;  // N/m, eq. 8a
  Friction TableFriction() const;
};

}  // namespace tactus

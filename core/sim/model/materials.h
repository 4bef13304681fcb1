// File: materials.h
//
// Materials of cubes: the paper's 13 materials (Table "Material Selection for
// Simulations"; materials.csv, built in) and tables of the same form.
//
//   TACTUS_ASSIGN_OR_RETURN(auto more, ParseMaterials(csv_text));
//   Cube cube = {more[0], /*edge_m=*/0.05, Surface::kGlass};
//
// Stateless; thread-safe. Materials own their names.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

namespace tactus::internal {

enum class Surface { kWood, kGlass };

struct Friction {
  double mu_static = 0;
  double mu_kinetic = 0;
};

struct Material {
  std::string name;           // "abs-plastic"
  double youngs_modulus = 0;  // Pa
  double density = 0;         // kg/m^3
  Friction wood;
  Friction glass;
  double poisson_ratio = 0;
};

// All 13, in the table's order.
std::span<const Material> Materials();

// A table of at least one material as comma-separated text. The first line is
// the header
//   name,youngs_modulus_pa,density_kg_m3,wood_static,wood_kinetic,
//   glass_static,glass_kinetic,poisson_ratio
// (in one line). Blank lines and lines that begin with # are skipped.
// INVALID_SCENE with line and column of the first error.
absl::StatusOr<std::vector<Material>> ParseMaterials(absl::string_view csv);

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

}  // namespace tactus::internal

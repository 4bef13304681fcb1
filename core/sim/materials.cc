#include "core/sim/materials.h"

namespace tactus {
namespace {

// Name, E (Pa), density (kg/m^3), static and kinetic friction on wood and on
// glass, Poisson's ratio.
constexpr Material kMaterials[] = {
    {"abs-plastic", 1.60e9, 1110.00, {0.50, 0.40}, {0.30, 0.25}, 0.41},
    {"glass", 6.25e10, 2250.00, {0.17, 0.14}, {0.95, 0.35}, 0.20},
    {"pine-wood", 1.68e10, 520.00, {0.50, 0.364}, {0.36, 0.14}, 0.38},
    {"ceramic", 7.00e10, 2250.00, {0.50, 0.40}, {0.42, 0.35}, 0.18},
    {"steel", 2.00e11, 7850.00, {0.61, 0.35}, {0.13, 0.12}, 0.27},
    {"polymer-foam", 2.50e5, 54.00, {0.12, 0.11}, {0.37, 0.30}, 0.27},
    {"light-foam", 3.30e4, 16.00, {0.12, 0.11}, {0.37, 0.30}, 0.28},
    {"soft-foam", 1.00e4, 48.06, {0.12, 0.11}, {0.55, 0.50}, 0.30},
    {"open-cell-foam", 2.20e4, 72.08, {0.12, 0.11}, {0.55, 0.50}, 0.30},
    {"natural-rubber", 2.00e6, 925.00, {0.90, 0.70}, {0.87, 0.70}, 0.50},
    {"neoprene-rubber", 1.35e6, 1240.00, {0.90, 0.70}, {0.87, 0.70}, 0.49},
    {"fat", 1.90e3, 919.60, {0.91, 0.60}, {0.45, 0.30}, 0.41},
    {"muscle", 1.28e4, 1060.00, {0.91, 0.60}, {0.45, 0.30}, 0.30},
};

}  // namespace

std::span<const Material> Materials() { return kMaterials; }

const Material* FindMaterial(absl::string_view name) {
  for (const Material& material : kMaterials) {
    if (material.name == name) return &material;
  }
  return nullptr;
}

absl::string_view SurfaceName(Surface surface) {
  return surface == Surface::kWood ? "wood" : "glass";
}

double Cube::Mass() const {
  return material.density * edge_m * edge_m * edge_m;
}

double Cube::Stiffness() const { return 2 * edge_m * material.youngs_modulus; }

Friction Cube::TableFriction() const {
  return surface == Surface::kWood ? material.wood : material.glass;
}

}  // namespace tactus

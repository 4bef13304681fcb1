#include "core/sim/model/materials.h"

#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"

// The assembler copies the file; TACTUS_MATERIALS is its path.
asm(".section .rodata\n"
    "tactus_materials_begin:\n"
    ".incbin \"" TACTUS_MATERIALS
    "\"\n"
    "tactus_materials_end:\n"
    ".byte 0\n"
    ".previous\n");

extern const char kMaterialsBegin[] asm("tactus_materials_begin");
extern const char kMaterialsEnd[] asm("tactus_materials_end");

namespace tactus::internal {
namespace {

struct Column {
  absl::string_view name;
  double low;
  double high;
};

// After the name.
constexpr Column kColumns[] = {
    {"youngs_modulus_pa", 1, 1e13}, {"density_kg_m3", 0.1, 1e5},
    {"wood_static", 1e-3, 10},      {"wood_kinetic", 1e-3, 10},
    {"glass_static", 1e-3, 10},     {"glass_kinetic", 1e-3, 10},
    {"poisson_ratio", 0, 0.5},
};
constexpr size_t kNumbers = std::size(kColumns);

std::string Header() {
  return absl::StrCat(
      "name,",
      absl::StrJoin(kColumns, ",", [](std::string* out, const auto& c) {
        absl::StrAppend(out, c.name);
      }));
}

std::string Place(int line, absl::string_view column) {
  return absl::StrCat("materials line ", line, ", ", column);
}

absl::Status CheckKinetic(const Friction& friction, int line,
                          absl::string_view column) {
  if (friction.mu_kinetic <= friction.mu_static) return absl::OkStatus();
  return InvalidScene(Place(line, column), friction.mu_kinetic,
                      "at most the static friction");
}

absl::StatusOr<Material> ParseRow(absl::string_view row, int line) {
  const std::vector<absl::string_view> cells = absl::StrSplit(row, ',');
  if (cells.size() != kNumbers + 1) {
    return InvalidScene(Place(line, "columns"), cells.size(),
                        absl::StrCat(kNumbers + 1));
  }
  Material material;
  material.name = std::string(absl::StripAsciiWhitespace(cells[0]));
  if (material.name.empty() || material.name.size() > limits::kMaxNameBytes) {
    return InvalidScene(Place(line, "name"), material.name,
                        absl::StrCat("1 to ", limits::kMaxNameBytes, " bytes"));
  }
  double* const places[kNumbers] = {
      &material.youngs_modulus,  &material.density,
      &material.wood.mu_static,  &material.wood.mu_kinetic,
      &material.glass.mu_static, &material.glass.mu_kinetic,
      &material.poisson_ratio,
  };
  for (size_t i = 0; i < kNumbers; ++i) {
    const Column& column = kColumns[i];
    // Written so that a NaN fails.
    if (!absl::SimpleAtod(cells[i + 1], places[i]) ||
        !(*places[i] >= column.low && *places[i] <= column.high)) {
      return InvalidScene(Place(line, column.name), cells[i + 1],
                          absl::StrCat(column.low, " to ", column.high));
    }
  }
  TACTUS_RETURN_IF_ERROR(CheckKinetic(material.wood, line, "wood_kinetic"));
  TACTUS_RETURN_IF_ERROR(CheckKinetic(material.glass, line, "glass_kinetic"));
  return material;
}

const Material* Find(std::span<const Material> materials,
                     absl::string_view name) {
  for (const Material& material : materials) {
    if (material.name == name) return &material;
  }
  return nullptr;
}

}  // namespace

absl::StatusOr<std::vector<Material>> ParseMaterials(absl::string_view csv) {
  std::vector<Material> materials;
  bool header = false;
  int line = 0;
  for (absl::string_view row : absl::StrSplit(csv, '\n')) {
    ++line;
    row = absl::StripAsciiWhitespace(row);
    if (row.empty() || row[0] == '#') continue;
    if (!header) {
      if (row != Header()) {
        return InvalidScene(Place(line, "header"), row, Header());
      }
      header = true;
      continue;
    }
    TACTUS_ASSIGN_OR_RETURN(Material material, ParseRow(row, line));
    if (Find(materials, material.name) != nullptr) {
      return InvalidScene(Place(line, "name"), material.name,
                          "a name that is not there yet");
    }
    materials.push_back(std::move(material));
  }
  if (materials.empty()) {
    return InvalidScene("materials", 0, "a header and at least one line");
  }
  return materials;
}

std::span<const Material> Materials() {
  // Never destroyed, so that it may be used at any time.
  static const auto& materials = *new std::vector<Material>(
      ParseMaterials(
          absl::string_view(kMaterialsBegin, kMaterialsEnd - kMaterialsBegin))
          .value());
  return materials;
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

}  // namespace tactus::internal

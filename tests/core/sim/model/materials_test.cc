#include "core/sim/model/materials.h"

#include <string>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

constexpr char kHeader[] =
    "name,youngs_modulus_pa,density_kg_m3,wood_static,wood_kinetic,"
    "glass_static,glass_kinetic,poisson_ratio\n";

TEST(ParseMaterialsTest, ReadsCommentsBlanksAndWindowsLines) {
  const auto materials = ParseMaterials(
      absl::StrCat("# two of ours\r\n\r\n", kHeader,
                   "cork,1.8e7,240,0.6,0.5,0.5,0.4,0.0\r\n",
                   " ice , 9e9, 917, 0.05,0.03, 0.1,0.02, 0.33"));
  ASSERT_TRUE(materials.ok()) << materials.status();
  ASSERT_EQ(materials->size(), 2);
  const Material& ice = materials->at(1);
  EXPECT_EQ(ice.name, "ice");
  EXPECT_EQ(ice.youngs_modulus, 9e9);
  EXPECT_EQ(ice.density, 917);
  EXPECT_EQ(ice.wood.mu_static, 0.05);
  EXPECT_EQ(ice.wood.mu_kinetic, 0.03);
  EXPECT_EQ(ice.glass.mu_static, 0.1);
  EXPECT_EQ(ice.glass.mu_kinetic, 0.02);
  EXPECT_EQ(ice.poisson_ratio, 0.33);
}

TEST(ParseMaterialsTest, NamesLineAndColumn) {
  const struct {
    std::string text;
    const char* field;
  } cases[] = {
      {"", "materials"},
      {kHeader, "materials"},
      {"cork,1,1,1,1,1,1,0\n", "materials line 1, header"},
      {absl::StrCat(kHeader, "cork,1e7,240,0.6,0.5,0.5,0.4\n"),
       "materials line 2, columns"},
      {absl::StrCat(kHeader, "#\n,1e7,240,0.6,0.5,0.5,0.4,0\n"),
       "materials line 3, name"},
      {absl::StrCat(kHeader, "cork,hard,240,0.6,0.5,0.5,0.4,0\n"),
       "materials line 2, youngs_modulus_pa"},
      {absl::StrCat(kHeader, "cork,1e7,nan,0.6,0.5,0.5,0.4,0\n"),
       "materials line 2, density_kg_m3"},
      {absl::StrCat(kHeader, "cork,1e7,240,0.6,0.7,0.5,0.4,0\n"),
       "materials line 2, wood_kinetic"},
      {absl::StrCat(kHeader, "cork,1e7,240,0.6,0.5,0.5,0.51,0\n"),
       "materials line 2, glass_kinetic"},
      {absl::StrCat(kHeader, "cork,1e7,240,0.6,0.5,0.5,0.4,0.6\n"),
       "materials line 2, poisson_ratio"},
      {absl::StrCat(kHeader, "a,1e7,240,0.6,0.5,0.5,0.4,0\n",
                    "a,1e7,240,0.6,0.5,0.5,0.4,0\n"),
       "materials line 3, name"},
  };
  for (const auto& c : cases) {
    const auto materials = ParseMaterials(c.text);
    EXPECT_EQ(ReasonOf(materials.status()), "INVALID_SCENE") << c.text;
    EXPECT_EQ(InfoOf(materials.status()).metadata().at("field"), c.field);
  }
}

}  // namespace
}  // namespace tactus::internal

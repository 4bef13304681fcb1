// Inner folds that leave out several materials listed their contacts material
// by material. Complement() took such a list for a sorted one and trained the
// fold's models on all materials but the first, so the calibration was too sure
// of itself.
#include "core/contacts/folds.h"
#include "gtest/gtest.h"

namespace tactus::internal {
namespace {

TEST(MaterialsThatWereNotLeftOutTest, TheOrderOfAFoldDoesNotMatter) {
  EXPECT_EQ(Complement({4, 6, 1, 3}, 8), (std::vector<int>{0, 2, 5, 7}));
}

}  // namespace
}  // namespace tactus::internal

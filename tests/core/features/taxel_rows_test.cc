#include "core/features/taxel_rows.h"

#include <cstdlib>
#include <set>
#include <utility>

#include "core/base/random.h"
#include "gtest/gtest.h"
#include "tests/support/flat_layout.h"

namespace tactus::internal {
namespace {

// The same sets as pairs of row and column.
using Plain = std::set<std::pair<int, int>>;

Plain ToPlain(const TaxelRows& rows) {
  Plain plain;
  for (int r = 0; r < limits::kMaxRows; ++r) {
    for (int c = 0; c < 64; ++c) {
      if ((rows[r] >> c & 1) != 0) plain.emplace(r, c);
    }
    EXPECT_TRUE(rows[r] == 0 || (r >= rows.first() && r < rows.end())) << r;
  }
  return plain;
}

TaxelRows RandomRows(const SkinLayout& layout, Random& random) {
  TaxelRows rows;
  // Some are empty, and some span a part of the skin.
  const uint64_t count = random.Index(12);
  const auto first = static_cast<int>(random.Index(layout.rows));
  for (uint64_t i = 0; i < count; ++i) {
    rows.Add(first + static_cast<int>(random.Index(layout.rows - first)),
             uint64_t{1} << random.Index(layout.columns));
  }
  return rows;
}

// Against sets of places, on skins of any width up to a whole word.
TEST(TaxelRowsTest, SetsAreThoseOfPlaces) {
  Random random(3);
  for (const int columns : {1, 2, 5, 31, 63, 64}) {
    for (const bool wrap : {false, true}) {
      SkinLayout layout = testing::FlatLayout(6, columns);
      layout.wrap_columns = wrap;
      const TaxelSets sets(layout);
      for (int run = 0; run < 50; ++run) {
        const TaxelRows a = RandomRows(layout, random);
        const TaxelRows b = RandomRows(layout, random);
        int common = 0;
        for (const auto& place : ToPlain(a)) common += ToPlain(b).count(place);
        EXPECT_EQ(sets.Overlap(a, b), common);
        EXPECT_EQ(sets.Overlaps(a, b), common > 0);
        EXPECT_EQ(sets.Count(a), static_cast<int>(ToPlain(a).size()));

        const int down = static_cast<int>(random.Index(9)) - 4;
        const int right = static_cast<int>(random.Index(2 * columns)) - columns;
        Plain grown;
        Plain moved;
        const auto put = [&](int row, int column, Plain& into) {
          if (wrap) column = ((column % columns) + columns) % columns;
          if (row < 0 || row >= 6 || column < 0 || column >= columns) return;
          into.emplace(row, column);
        };
        for (const auto& [row, column] : ToPlain(a)) {
          for (int r = -1; r <= 1; ++r) {
            for (int c = -1; c <= 1; ++c) put(row + r, column + c, grown);
          }
          put(row + down, column + right, moved);
        }
        TaxelRows changed = a;
        sets.Grow(changed);
        EXPECT_EQ(ToPlain(changed), grown) << columns << wrap;
        changed = a;
        sets.Move(down, right, changed);
        EXPECT_EQ(ToPlain(changed), moved) << columns << wrap;
        changed = a;
        sets.Add(b, changed);
        sets.Remove(a, changed);
        EXPECT_EQ(sets.Overlap(changed, a), 0);
        EXPECT_EQ(sets.Count(changed), sets.Count(b) - common);
        changed = b;
        EXPECT_EQ(ToPlain(changed), ToPlain(b));
        changed.Clear();
        EXPECT_EQ(ToPlain(changed), Plain());
      }
    }
  }
}

}  // namespace
}  // namespace tactus::internal

#include "core/trees/fit_trees.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/random.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Rows of numbers and their classes.
struct Table {
  size_t numbers = 0;
  std::vector<float> value;  // [numbers][rows]
  std::vector<int> label;

  float at(uint32_t row, size_t number) const {
    return value[number * label.size() + row];
  }
};

Table MakeTable(std::span<const HistorySample> samples,
                const HistorySpec& spec) {
  Table table;
  table.numbers = spec.numbers();
  const size_t rows = samples.size() * kHistoryParts.size();
  table.value.resize(rows * table.numbers);
  std::vector<float> numbers(table.numbers);
  TouchHistory history(&spec);
  for (const HistorySample& sample : samples) {
    history.Reset();
    size_t t = 0;
    for (const double part : kHistoryParts) {
      for (const size_t end = EndOf(part, sample.frames.size()); t < end; ++t) {
        history.Step(sample.frames[t]);
      }
      history.Write(numbers);
      float* value = table.value.data() + table.label.size();
      for (const float number : numbers) {
        *value = number;
        value += rows;
      }
      table.label.push_back(sample.label);
    }
  }
  return table;
}

struct Split {
  size_t number = 0;
  float threshold = 0;
  double impurity = 0;
};

class Grower {
 public:
  Grower(const Table& table, int classes, Trees& trees)
      : table_(table),
        tried_(std::max<size_t>(1, static_cast<size_t>(std::lround(std::sqrt(
                                       static_cast<double>(table.numbers)))))),
        left_(classes),
        all_(classes),
        trees_(trees) {
    const auto rows = static_cast<uint32_t>(table.label.size());
    for (size_t number = 0; number < table.numbers; ++number) {
      for (uint32_t row = 1; row < rows; ++row) {
        if (table.at(row, number) == table.at(0, number)) continue;
        order_.push_back(number);
        break;
      }
    }
  }

  void Grow(Random& random) {
    std::vector<uint32_t> rows(table_.label.size());
    std::iota(rows.begin(), rows.end(), 0U);
    trees_.root.push_back(AddNodes(1));
    struct Open {
      uint32_t node;
      size_t begin;
      size_t end;
    };
    std::vector<Open> open = {{trees_.root.back(), 0, rows.size()}};
    while (!open.empty()) {
      const auto [node, begin, end] = open.back();
      open.pop_back();
      const std::span<uint32_t> here(rows.data() + begin, end - begin);
      Count(here);
      Split split;
      if (IsPure() || !Find(here, random, split)) {
        const auto most = std::ranges::max_element(all_) - all_.begin();
        trees_.number[node] = -1 - static_cast<int32_t>(most);
        continue;
      }
      const auto middle =
          std::partition(here.begin(), here.end(), [&](uint32_t row) {
            return table_.at(row, split.number) < split.threshold;
          });
      const size_t cut = begin + (middle - here.begin());
      const uint32_t child = AddNodes(2);
      trees_.number[node] = static_cast<int32_t>(split.number);
      trees_.threshold[node] = split.threshold;
      trees_.child[node] = child;
      open.push_back({child + 1, cut, end});
      open.push_back({child, begin, cut});
    }
  }

 private:
  uint32_t AddNodes(size_t count) {
    const size_t first = trees_.number.size();
    trees_.number.resize(first + count);
    trees_.threshold.resize(first + count);
    trees_.child.resize(first + count);
    return static_cast<uint32_t>(first);
  }

  void Count(std::span<const uint32_t> rows) {
    std::ranges::fill(all_, 0);
    for (const uint32_t row : rows) ++all_[table_.label[row]];
  }

  bool IsPure() const {
    return std::ranges::count_if(all_, [](int n) { return n > 0; }) == 1;
  }

  // The best of `tried_` numbers that differ within the rows; false if none
  // does. Draws more numbers as long as those drawn are constant.
  bool Find(std::span<const uint32_t> rows, Random& random, Split& best) {
    size_t found = 0;
    for (size_t i = 0; i < order_.size() && found < tried_; ++i) {
      std::swap(order_[i], order_[i + random.Index(order_.size() - i)]);
      const size_t number = order_[i];
      float least = table_.at(rows.front(), number);
      float most = least;
      for (const uint32_t row : rows) {
        least = std::min(least, table_.at(row, number));
        most = std::max(most, table_.at(row, number));
      }
      if (!(least < most)) continue;
      // Above the least and not above the most, so that both sides have rows.
      const auto threshold =
          std::clamp(static_cast<float>(random.Uniform(least, most)),
                     std::nextafter(least, most), most);
      const double impurity = ImpurityOf(rows, number, threshold);
      if (found == 0 || impurity < best.impurity) {
        best = {number, threshold, impurity};
      }
      ++found;
    }
    return found > 0;
  }

  // Gini impurity of both sides, weighted by their rows.
  double ImpurityOf(std::span<const uint32_t> rows, size_t number,
                    float threshold) {
    std::ranges::fill(left_, 0);
    int below = 0;
    for (const uint32_t row : rows) {
      if (!(table_.at(row, number) < threshold)) continue;
      ++left_[table_.label[row]];
      ++below;
    }
    const int above = static_cast<int>(rows.size()) - below;
    double left = 0;
    double right = 0;
    for (size_t k = 0; k < all_.size(); ++k) {
      const double l = left_[k];
      const double r = all_[k] - left_[k];
      left += l * l;
      right += r * r;
    }
    return static_cast<double>(rows.size()) - left / below - right / above;
  }

  const Table& table_;
  const size_t tried_;
  // Rows of each class: below a threshold, and in the node.
  std::vector<int> left_;
  std::vector<int> all_;
  // The numbers that are not the same in all rows, in any order.
  std::vector<size_t> order_;
  Trees& trees_;
};

}  // namespace

absl::StatusOr<Trees> FitTrees(std::span<const HistorySample> samples,
                               const TreesOptions& options) {
  Trees trees;
  static_cast<FrameViews&>(trees.history) = FitViews(samples, options.shape);
  trees.classes = options.classes;
  const Table table = MakeTable(samples, trees.history);
  Grower grower(table, options.classes, trees);
  for (int t = 0; t < options.trees; ++t) {
    TACTUS_RETURN_IF_ERROR(options.go_on());
    Random random = Random::ForStream(options.seed, t);
    grower.Grow(random);
    if (trees.number.size() > kMostTreeNodes) {
      return InvalidTrainingData(
          absl::StrCat(t + 1, " trees of ", samples.size(), " contacts have ",
                       trees.number.size(), " nodes, but all ", options.trees,
                       " may have at most ", kMostTreeNodes));
    }
  }
  return trees;
}

}  // namespace tactus::internal

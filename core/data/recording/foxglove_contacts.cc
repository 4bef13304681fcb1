#include "core/data/recording/foxglove_contacts.h"

#include <algorithm>
#include <vector>

#include "absl/strings/str_cat.h"
#include "core/data/recording/foxglove_schema.h"

namespace tactus::internal {
namespace {

constexpr char kImageAnnotations[] = R"(
message Point2 {
  double x = 1;
  double y = 2;
}
message Color {
  double r = 1;
  double g = 2;
  double b = 3;
  double a = 4;
}
message CircleAnnotation {
  google.protobuf.Timestamp timestamp = 1;
  Point2 position = 2;
  double diameter = 3;
  double thickness = 4;
  Color fill_color = 5;
  Color outline_color = 6;
}
message PointsAnnotation {
  enum Type {
    UNKNOWN = 0;
    POINTS = 1;
    LINE_LOOP = 2;
    LINE_STRIP = 3;
    LINE_LIST = 4;
  }
  google.protobuf.Timestamp timestamp = 1;
  Type type = 2;
  repeated Point2 points = 3;
  Color outline_color = 4;
  repeated Color outline_colors = 5;
  Color fill_color = 6;
  double thickness = 7;
}
message TextAnnotation {
  google.protobuf.Timestamp timestamp = 1;
  Point2 position = 2;
  string text = 3;
  double font_size = 4;
  Color text_color = 5;
  Color background_color = 6;
}
message ImageAnnotations {
  repeated CircleAnnotation circles = 1;
  repeated PointsAnnotation points = 2;
  repeated TextAnnotation texts = 3;
  google.protobuf.Timestamp timestamp = 5;
})";

// Field numbers of the messages above.
enum AnnotationsField { kPoints = 2, kTexts = 3, kAnnotationsTime = 5 };
enum PointsField {
  kPointsTime = 1,
  kPointsType = 2,
  kPointsPoints = 3,
  kPointsColor = 4,
  kPointsThickness = 7,
};
enum TextField {
  kTextTime = 1,
  kTextPosition = 2,
  kTextText = 3,
  kTextSize = 4,
  kTextColor = 5,
  kTextGround = 6,
};
constexpr uint32_t kLineList = 4;

// The server's measure: an event says so when `unknown` rises above this.
constexpr double kIsUnknown = 0.5;
// A letter's height, of that of the picture, and at least in taxels.
constexpr double kLetterHeight = 1.0 / 12;
constexpr double kLeastLetter = 1;
constexpr double kLineWidth = 0.15;

ProtoFields PointAt(double x, double y) {
  ProtoFields point;
  point.AddDouble(1, x);
  point.AddDouble(2, y);
  return point;
}

ProtoFields ColorOf(double red, double green, double blue, double alpha) {
  ProtoFields color;
  color.AddDouble(1, red);
  color.AddDouble(2, green);
  color.AddDouble(3, blue);
  color.AddDouble(4, alpha);
  return color;
}

// Grey pictures have neither of them.
ProtoFields Amber() { return ColorOf(1, 0.7, 0.1, 1); }
ProtoFields Ground() { return ColorOf(0, 0, 0, 0.6); }

// The taxels of a region.
class TouchedTaxels {
 public:
  TouchedTaxels(const v1::ContactPatch& patch, int rows, int columns)
      : rows_(rows),
        columns_(columns),
        top_(rows),
        left_(columns),
        touched_(static_cast<size_t>(rows) * static_cast<size_t>(columns)) {
    for (const uint32_t taxel : patch.taxels()) {
      if (taxel >= touched_.size()) continue;
      touched_[taxel] = 1;
      const int row = static_cast<int>(taxel) / columns;
      top_ = std::min(top_, row);
      bottom_ = std::max(bottom_, row + 1);
      left_ = std::min(left_, static_cast<int>(taxel) % columns);
    }
  }

  bool empty() const { return bottom_ == 0; }
  int top() const { return top_; }
  int bottom() const { return bottom_; }
  int left() const { return left_; }

  // Calls `line` with the ends of each straight part of the border.
  template <typename Line>
  void ForEachLine(const Line& line) const {
    for (int row = 0; row <= rows_; ++row) {
      ForEachRun(
          columns_, [&](int c) { return Has(row, c) != Has(row - 1, c); },
          [&](int from, int to) { line(from, row, to, row); });
    }
    for (int column = 0; column <= columns_; ++column) {
      ForEachRun(
          rows_, [&](int r) { return Has(r, column) != Has(r, column - 1); },
          [&](int from, int to) { line(column, from, column, to); });
    }
  }

 private:
  // Nothing is touched beyond the skin.
  bool Has(int row, int column) const {
    return row >= 0 && row < rows_ && column >= 0 && column < columns_ &&
           touched_[static_cast<size_t>(row * columns_ + column)] != 0;
  }

  // Calls `run` with the begin and the end of each run of numbers below `end`
  // for which `is_in` is true.
  template <typename IsIn, typename Run>
  static void ForEachRun(int end, const IsIn& is_in, const Run& run) {
    int from = 0;
    for (int i = 0; i <= end; ++i) {
      if (i < end && is_in(i)) continue;
      if (i > from) run(from, i);
      from = i + 1;
    }
  }

  int rows_;
  int columns_;
  int top_;
  int bottom_ = 0;
  int left_;
  std::vector<char> touched_;
};

// "2: hard, moved".
std::string TextOf(const v1::Contact& contact,
                   const FoxgloveContacts::Questions& questions) {
  std::string text = absl::StrCat(contact.id());
  if (contact.unknown() > kIsUnknown) return absl::StrCat(text, ": unknown");
  const char* between = ": ";
  const int count = std::min(contact.answers_size(), questions.size());
  for (int q = 0; q < count; ++q) {
    if (!contact.answers(q).has_decision()) continue;
    const uint32_t value = contact.answers(q).decision().value();
    const auto& values = questions[q].values();
    if (value >= static_cast<uint32_t>(values.size())) continue;
    absl::StrAppend(&text, between, values[static_cast<int>(value)]);
    between = ", ";
  }
  return text;
}

}  // namespace

McapSchema FoxgloveContacts::Schema() {
  return FoxgloveSchema("foxglove.ImageAnnotations", kImageAnnotations);
}

std::string FoxgloveContacts::Encode(const v1::Answer& answer) const {
  const double letter = std::max(kLeastLetter, kLetterHeight * layout_.rows);
  ProtoFields annotations;
  for (const v1::Contact& contact : answer.contacts()) {
    const TouchedTaxels region(contact.patch(), layout_.rows, layout_.columns);
    if (region.empty()) continue;
    ProtoFields outline;
    outline.AddTime(kPointsTime, answer.capture_time_ns());
    outline.AddEnum(kPointsType, kLineList);
    region.ForEachLine([&](int x0, int y0, int x1, int y1) {
      outline.AddMessage(kPointsPoints, PointAt(x0, y0));
      outline.AddMessage(kPointsPoints, PointAt(x1, y1));
    });
    outline.AddMessage(kPointsColor, Amber());
    outline.AddDouble(kPointsThickness, kLineWidth);
    annotations.AddMessage(kPoints, outline);

    // Above the region, or below it if there is no room.
    const double y =
        region.top() >= letter ? region.top() : region.bottom() + letter;
    ProtoFields text;
    text.AddTime(kTextTime, answer.capture_time_ns());
    text.AddMessage(kTextPosition, PointAt(region.left(), y));
    text.AddBytes(kTextText, TextOf(contact, questions_));
    text.AddDouble(kTextSize, letter);
    text.AddMessage(kTextColor, Amber());
    text.AddMessage(kTextGround, Ground());
    annotations.AddMessage(kTexts, text);
  }
  annotations.AddTime(kAnnotationsTime, answer.capture_time_ns());
  return annotations.bytes();
}

}  // namespace tactus::internal

#include "core/data/trial_filter.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "core/base/errors.h"
#include "core/base/status_macros.h"

namespace tactus::internal {
namespace {

// Keeps recursion small.
constexpr int kMostDepth = 32;

// Below 0, 0 or above 0, as `a` is below, equal to or above `b`.
int Compare(const std::string& a, const std::string& b) {
  double x = 0;
  double y = 0;
  if (absl::SimpleAtod(a, &x) && absl::SimpleAtod(b, &y)) {
    return x < y ? -1 : x > y ? 1 : 0;
  }
  return a.compare(b);
}

bool Holds(const std::string& op, int order) {
  if (op == "=" || op == "==") return order == 0;
  if (op == "!=") return order != 0;
  if (op == "<") return order < 0;
  if (op == "<=") return order <= 0;
  if (op == ">") return order > 0;
  return order >= 0;
}

bool IsWordCharacter(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' ||
         c == '.' || c == '-' || c == '+' ||
         static_cast<unsigned char>(c) > 127;
}

struct Token {
  enum Kind { kEnd, kWord, kQuoted, kSign } kind = kEnd;
  std::string text;
  // Where it begins, from 1.
  size_t at = 0;
};

}  // namespace

// A comparison, or some others joined.
struct TrialFilter::Node {
  enum Kind { kCompare, kIn, kAnd, kOr, kNot } kind = kCompare;
  std::string field;
  std::string op;
  std::vector<std::string> values;
  std::vector<std::unique_ptr<const Node>> parts;

  bool Matches(
      absl::FunctionRef<std::string(const std::string&)> field_of) const {
    const auto part_matches = [&](const auto& part) {
      return part->Matches(field_of);
    };
    switch (kind) {
      case kAnd:
        return std::ranges::all_of(parts, part_matches);
      case kOr:
        return std::ranges::any_of(parts, part_matches);
      case kNot:
        return !part_matches(parts.front());
      case kIn: {
        const std::string value = field_of(field);
        return std::ranges::any_of(values, [&](const std::string& wanted) {
          return Compare(value, wanted) == 0;
        });
      }
      case kCompare:
        break;
    }
    return Holds(op, Compare(field_of(field), values.front()));
  }
};

class TrialFilter::Parser {
 public:
  using Result = absl::StatusOr<std::unique_ptr<const Node>>;

  explicit Parser(absl::string_view text) : text_(text) {}

  absl::StatusOr<TrialFilter> Parse() {
    TACTUS_RETURN_IF_ERROR(Next());
    TrialFilter filter;
    TACTUS_ASSIGN_OR_RETURN(filter.root_, Joined(0));
    if (token_.kind != Token::kEnd) return Wrong("and, or, or the end");
    filter.fields_ = std::move(fields_);
    return filter;
  }

 private:
  absl::Status Wrong(absl::string_view wanted) const {
    return InvalidConfig(
        "expression of trials",
        absl::StrCat(text_, ", at character ", token_.at, " ",
                     token_.kind == Token::kEnd
                         ? "the end"
                         : absl::StrCat("\"", token_.text, "\"")),
        absl::StrCat(wanted, " there"));
  }

  // Reads the next token.
  absl::Status Next() {
    while (at_ < text_.size() &&
           absl::ascii_isspace(static_cast<unsigned char>(text_[at_]))) {
      ++at_;
    }
    token_ = {Token::kEnd, "", at_ + 1};
    if (at_ == text_.size()) return absl::OkStatus();
    const char first = text_[at_];
    if (first == '\'' || first == '"') {
      const size_t end = text_.find(first, at_ + 1);
      if (end == absl::string_view::npos) {
        token_.text = std::string(text_.substr(at_));
        token_.kind = Token::kSign;
        return Wrong("the quote ended");
      }
      token_.kind = Token::kQuoted;
      token_.text = std::string(text_.substr(at_ + 1, end - at_ - 1));
      at_ = end + 1;
      return absl::OkStatus();
    }
    size_t end = at_;
    while (end < text_.size() && IsWordCharacter(text_[end])) ++end;
    token_.kind = end > at_ ? Token::kWord : Token::kSign;
    if (end == at_) {
      end = at_ + 1;
      if (end < text_.size() && text_[end] == '=') ++end;
    }
    token_.text = std::string(text_.substr(at_, end - at_));
    at_ = end;
    return absl::OkStatus();
  }

  bool Is(Token::Kind kind, absl::string_view text) const {
    return token_.kind == kind && token_.text == text;
  }

  // Parts joined by "or", each of them of parts joined by "and".
  Result Joined(int depth) {
    if (depth > kMostDepth) return Wrong("fewer parentheses around it");
    return Chain("or", Node::kOr, [this, depth] {
      return Chain("and", Node::kAnd, [this, depth] { return Part(depth); });
    });
  }

  template <class ReadPart>
  Result Chain(absl::string_view word, Node::Kind kind,
               const ReadPart& read_part) {
    auto node = std::make_unique<Node>();
    node->kind = kind;
    while (true) {
      TACTUS_ASSIGN_OR_RETURN(auto part, read_part());
      node->parts.push_back(std::move(part));
      if (!Is(Token::kWord, word)) return node;
      TACTUS_RETURN_IF_ERROR(Next());
    }
  }

  Result Part(int depth) {
    if (Is(Token::kWord, "not")) {
      TACTUS_RETURN_IF_ERROR(Next());
      auto node = std::make_unique<Node>();
      node->kind = Node::kNot;
      if (depth >= kMostDepth) return Wrong("fewer nots before it");
      TACTUS_ASSIGN_OR_RETURN(auto part, Part(depth + 1));
      node->parts.push_back(std::move(part));
      return node;
    }
    if (!Is(Token::kSign, "(")) return Comparison();
    TACTUS_RETURN_IF_ERROR(Next());
    TACTUS_ASSIGN_OR_RETURN(auto node, Joined(depth + 1));
    TACTUS_RETURN_IF_ERROR(Expect(")"));
    return node;
  }

  Result Comparison() {
    if (token_.kind != Token::kWord) return Wrong("the name of a field");
    auto node = std::make_unique<Node>();
    node->field = token_.text;
    if (std::ranges::find(fields_, node->field) == fields_.end()) {
      fields_.push_back(node->field);
    }
    TACTUS_RETURN_IF_ERROR(Next());
    if (Is(Token::kWord, "in")) {
      node->kind = Node::kIn;
      TACTUS_RETURN_IF_ERROR(Next());
      TACTUS_RETURN_IF_ERROR(Expect("("));
      while (true) {
        TACTUS_RETURN_IF_ERROR(Value(*node));
        if (!Is(Token::kSign, ",")) break;
        TACTUS_RETURN_IF_ERROR(Next());
      }
      TACTUS_RETURN_IF_ERROR(Expect(")"));
      return node;
    }
    constexpr absl::string_view kOperators[] = {"=",  "==", "!=", "<",
                                                "<=", ">",  ">="};
    if (token_.kind != Token::kSign ||
        std::ranges::find(kOperators, token_.text) == std::end(kOperators)) {
      return Wrong("one of = != < <= > >= in");
    }
    node->op = token_.text;
    TACTUS_RETURN_IF_ERROR(Next());
    TACTUS_RETURN_IF_ERROR(Value(*node));
    return node;
  }

  absl::Status Value(Node& node) {
    if (token_.kind != Token::kWord && token_.kind != Token::kQuoted) {
      return Wrong("a value");
    }
    node.values.push_back(token_.text);
    return Next();
  }

  absl::Status Expect(absl::string_view sign) {
    if (!Is(Token::kSign, sign)) return Wrong(absl::StrCat("\"", sign, "\""));
    return Next();
  }

  const absl::string_view text_;
  size_t at_ = 0;
  Token token_;
  std::vector<std::string> fields_;
};

TrialFilter::TrialFilter() = default;
TrialFilter::TrialFilter(TrialFilter&&) noexcept = default;
TrialFilter& TrialFilter::operator=(TrialFilter&&) noexcept = default;
TrialFilter::~TrialFilter() = default;

absl::StatusOr<TrialFilter> TrialFilter::Parse(absl::string_view text) {
  if (text.size() > kMostBytes) {
    return InvalidConfig("bytes of an expression of trials", text.size(),
                         absl::StrCat("at most ", kMostBytes));
  }
  return Parser(text).Parse();
}

bool TrialFilter::Matches(
    absl::FunctionRef<std::string(const std::string&)> field_of) const {
  return root_->Matches(field_of);
}

}  // namespace tactus::internal

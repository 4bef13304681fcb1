#include "tests/examples/header_example.h"

#include <sstream>

namespace tactus::internal {
namespace {

bool HoldsSemicolon(const std::string& line) {
  return line.substr(0, line.find("//")).find(';') != std::string::npos;
}

}  // namespace

std::string HeaderExample(const std::string& header) {
  std::string example;
  std::string block;
  bool is_code = false;
  const auto end_block = [&] {
    if (is_code) example += example.empty() ? block : "\n" + block;
    block.clear();
    is_code = false;
  };
  std::istringstream lines(header);
  std::string before;
  for (std::string line; std::getline(lines, line); before = line) {
    if (!line.starts_with("//")) break;
    if (line.starts_with("//   ") && (!block.empty() || before == "//")) {
      block += line.substr(2) + "\n";
      is_code = is_code || HoldsSemicolon(line.substr(2));
    } else {
      end_block();
    }
  }
  end_block();
  return example;
}

}  // namespace tactus::internal

// Writes the examples of headers as texts to include. Run in the project's
// root,
//
//   example_texts OUT core/base/errors.h ...
//
// writes OUT/core/base/errors.h.inc. A header without an example gets an empty
// file, because the build awaits one for each header.
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <optional>
#include <string>

#include "tests/examples/header_example.h"

namespace {

namespace fs = std::filesystem;

std::optional<std::string> ReadText(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(in), {});
}

// Leaves a file that holds `text` as it is, so that nothing is compiled again.
bool Write(const fs::path& path, const std::string& text) {
  if (ReadText(path) == text) return true;
  fs::create_directories(path.parent_path());
  std::ofstream out(path, std::ios::binary);
  out << text << std::flush;
  return out.good();
}

}  // namespace

int main(int argc, char** argv) {
  for (int i = 2; i < argc; ++i) {
    const std::string header = argv[i];
    const std::optional<std::string> text = ReadText(header);
    if (!text || !Write(fs::path(argv[1]) / (header + ".inc"),
                        tactus::internal::HeaderExample(*text))) {
      std::cerr << "example_texts: cannot read " << header
                << " or write its example\n";
      return 1;
    }
  }
}

// A fuzz target without libFuzzer, for the quick tests: the empty input, the
// files of its corpus, and inputs that follow from a seed. Half of these are
// files of the corpus with damage, the others any bytes.
//
//   skin_bytes_fuzzer_check RUNS SEED [CORPUS]
//
// libFuzzer finds more, because it sees which code an input reaches
// (CONTRIBUTING.md).
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "core/base/random.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);

namespace {

using tactus::internal::Random;

constexpr double kMaxBytes = 4096;

void Run(const std::string& input) {
  LLVMFuzzerTestOneInput(reinterpret_cast<const uint8_t*>(input.data()),
                         input.size());
}

// Short ones as often as long ones.
std::string AnyBytes(Random& random, double most) {
  const double size = std::pow(most, random.Uniform());
  std::string bytes(static_cast<size_t>(size), '\0');
  for (char& byte : bytes) byte = static_cast<char>(random.Index(256));
  return bytes;
}

std::string Damage(std::string bytes, Random& random) {
  for (size_t i = 0; i <= random.Index(8) && !bytes.empty(); ++i) {
    const size_t at = random.Index(bytes.size());
    switch (random.Index(4)) {
      case 0:
        bytes[at] = static_cast<char>(random.Index(256));
        break;
      case 1:
        bytes[at] = static_cast<char>(bytes[at] ^ 1 << random.Index(8));
        break;
      case 2:
        bytes.erase(at, 1 + random.Index(32));
        break;
      default:
        bytes.insert(at, AnyBytes(random, 32));
    }
  }
  return bytes;
}

std::vector<std::string> ReadCorpus(const char* folder) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    paths.push_back(entry.path());
  }
  // The order of a folder is any.
  std::sort(paths.begin(), paths.end());
  std::vector<std::string> inputs;
  for (const std::string& path : paths) {
    std::ifstream in(path, std::ios::binary);
    inputs.emplace_back(std::istreambuf_iterator<char>(in),
                        std::istreambuf_iterator<char>());
  }
  return inputs;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s RUNS SEED [CORPUS]\n", argv[0]);
    return 2;
  }
  const long runs = std::atol(argv[1]);
  Random random(std::strtoull(argv[2], nullptr, 10));
  std::vector<std::string> corpus;
  if (argc > 3) corpus = ReadCorpus(argv[3]);
  Run("");
  for (const std::string& input : corpus) Run(input);
  for (long i = 0; i < runs; ++i) {
    const bool damaged = !corpus.empty() && i % 2 == 0;
    Run(damaged ? Damage(corpus[random.Index(corpus.size())], random)
                : AnyBytes(random, kMaxBytes));
  }
  std::printf("%zu files of the corpus, %ld inputs of seed %s\n", corpus.size(),
              runs, argv[2]);
  return 0;
}

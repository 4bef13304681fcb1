// Damages Keras files. Each is read in a child process first, so this is slow;
// the child may die of what HDF5 does, this process may not.
#include "core/interchange/lstm/lstm_from_keras.h"
#include "tests/fuzz/damaged.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace tactus;
  static const auto* const good = new std::vector<std::string>{
      fuzz::Golden("interchange/keras2-weights.h5"),
      fuzz::Golden("interchange/keras2-model.h5"),
      fuzz::Golden("interchange/keras3.weights.h5")};
  FuzzedDataProvider data(bytes, size);
  const std::string path = fuzz::Write("x.h5", fuzz::Damaged(*good, data));
  const absl::Status status = LstmsFromKeras(path, {}).status();
  fuzz::RequireReason(status);
  // The good files are good.
  REQUIRE(size > 0 || status.ok());
  return 0;
}

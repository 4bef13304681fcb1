// Feeds arbitrary bytes to the bundle reader: as a file, and as the payload
// behind a right envelope, which a checksum alone would keep out.
#include <cstdint>

#include "core/bundle/bundle.h"
#include "core/bundle/model_proto.h"
#include "core/classify/compiled_model.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const absl::string_view bytes(reinterpret_cast<const char*>(data), size);
  if (tactus::internal::DecodeBundle(bytes).ok()) __builtin_trap();
  tactus::v1::ModelBundle message;
  if (!message.ParseFromArray(data, static_cast<int>(size))) return 0;
  auto model = tactus::internal::ModelFromProto(message);
  if (!model.ok()) return 0;
  auto compiled = tactus::internal::CompiledModel::Create(*std::move(model));
  if (compiled.ok()) tactus::internal::RunWarmUp(**compiled).IgnoreError();
  return 0;
}

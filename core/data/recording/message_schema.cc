#include "core/data/recording/message_schema.h"

#include <set>

#include "core/base/serialize.h"
#include "google/protobuf/descriptor.pb.h"

namespace tactus::internal {
namespace {

// Files come after those that they import.
void AddFile(const google::protobuf::FileDescriptor& file,
             std::set<std::string>& added,
             google::protobuf::FileDescriptorSet& files) {
  if (!added.insert(file.name()).second) return;
  for (int i = 0; i < file.dependency_count(); ++i) {
    AddFile(*file.dependency(i), added, files);
  }
  file.CopyTo(files.add_file());
}

}  // namespace

McapSchema MessageSchema(const google::protobuf::Descriptor& message) {
  std::set<std::string> added;
  google::protobuf::FileDescriptorSet files;
  AddFile(*message.file(), added, files);
  return {message.full_name(), "protobuf", SerializeDeterministic(files)};
}

McapSchema JsonSchema(const std::string& name) {
  return {name, "jsonschema", R"({"type": "object"})"};
}

}  // namespace tactus::internal

// File: foreign_decoder.h
//
// ForeignDecoder: decodes messages as another program does, with their schema
// alone. Test-only.
//
//   ForeignDecoder decoder(schema);
//   EXPECT_EQ(decoder.Text(bytes), "x: 1");
#pragma once

#include <memory>
#include <string>

#include "absl/strings/string_view.h"
#include "core/files/mcap/mcap_records.h"
#include "google/protobuf/descriptor.pb.h"
#include "google/protobuf/dynamic_message.h"
#include "gtest/gtest.h"

namespace tactus::internal {

class ForeignDecoder {
 public:
  explicit ForeignDecoder(const McapSchema& schema) {
    google::protobuf::FileDescriptorSet files;
    EXPECT_TRUE(files.ParseFromString(schema.data));
    for (const auto& file : files.file()) {
      EXPECT_NE(pool_.BuildFile(file), nullptr) << file.name();
    }
    type_ = pool_.FindMessageTypeByName(schema.name);
    EXPECT_NE(type_, nullptr) << schema.name;
  }

  // All fields are known.
  std::unique_ptr<google::protobuf::Message> Decode(absl::string_view data) {
    std::unique_ptr<google::protobuf::Message> message(
        factory_.GetPrototype(type_)->New());
    EXPECT_TRUE(message->ParseFromString(std::string(data)));
    EXPECT_TRUE(message->GetReflection()->GetUnknownFields(*message).empty());
    return message;
  }
  std::string Text(absl::string_view data) {
    return Decode(data)->ShortDebugString();
  }

 private:
  google::protobuf::DescriptorPool pool_;
  google::protobuf::DynamicMessageFactory factory_{&pool_};
  const google::protobuf::Descriptor* type_ = nullptr;
};

}  // namespace tactus::internal

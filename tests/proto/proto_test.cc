#include <cstdlib>
#include <fstream>
#include <functional>

#include "absl/strings/match.h"
#include "gmock/gmock.h"
#include "google/protobuf/compiler/parser.h"
#include "google/protobuf/io/tokenizer.h"
#include "google/protobuf/io/zero_copy_stream_impl_lite.h"
#include "gtest/gtest.h"
#include "tests/proto/breaking_changes.h"
#include "tests/proto/proto_lint.h"

namespace tactus::internal {
namespace {

using google::protobuf::DescriptorProto;
using google::protobuf::FieldDescriptorProto;
using google::protobuf::FileDescriptorProto;
using google::protobuf::FileDescriptorSet;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

FileDescriptorSet ReadSet(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  FileDescriptorSet set;
  EXPECT_TRUE(in.good() && set.ParseFromIstream(&in)) << path;
  return set;
}

FileDescriptorSet Current() { return ReadSet(TACTUS_DESCRIPTOR_SET); }

FileDescriptorSet Golden() {
  const char* source = std::getenv("TACTUS_SOURCE_DIR");
  return ReadSet(std::string(source == nullptr ? "." : source) +
                 "/tests/golden/tactus_v1.desc");
}

FileDescriptorProto ParseProto(const std::string& text) {
  google::protobuf::io::ArrayInputStream input(text.data(),
                                               static_cast<int>(text.size()));
  google::protobuf::io::Tokenizer tokenizer(&input, nullptr);
  google::protobuf::compiler::Parser parser;
  FileDescriptorProto file;
  EXPECT_TRUE(parser.Parse(&tokenizer, &file)) << text;
  file.set_name("tactus/v1/sample.proto");
  return file;
}

TEST(ProtoLintTest, TheContractIsClean) {
  const FileDescriptorSet set = Current();
  int ours = 0;
  for (const FileDescriptorProto& file : set.file()) {
    if (absl::StartsWith(file.name(), "google/")) continue;
    ++ours;
    EXPECT_THAT(Lint(file), IsEmpty()) << file.name();
  }
  EXPECT_EQ(ours, 11);
  EXPECT_THAT(SharedMessages(set), IsEmpty());
}

const std::string kHead =
    "// File.\nsyntax = \"proto3\";\npackage tactus.v1;\n";

TEST(ProtoLintTest, ACleanSamplePasses) {
  EXPECT_THAT(Lint(ParseProto(kHead + R"(
// A.
service AService {
  // B.
  rpc Do(DoRequest) returns (stream DoResponse);
}
// C.
enum TaxelUnit {
  // D.
  TAXEL_UNIT_UNSPECIFIED = 0;
}
// E.
message DoRequest {
  // F.
  oneof which {
    // G.
    string a_name = 1;
  }
  // H.
  map<string, string> info = 2;
})")),
              IsEmpty());
}

struct BadProto {
  const char* complaint;
  const char* text;
};

TEST(ProtoLintTest, EachRuleCanFail) {
  const BadProto cases[] = {
      {"do_it: messages are named", "// A.\nmessage do_it {}"},
      {"A: has no comment", "message A {}"},
      {"A.x: has no comment", "// A.\nmessage A { string x = 1; }"},
      {"A.xY: fields are named",
       "// A.\nmessage A {\n // X.\n string xY = 1;\n}"},
      {"A.w: has no comment",
       "// A.\nmessage A { oneof w {\n // X.\n string x = 1;\n } }"},
      {"B: has no comment", "// A.\nmessage A { message B {} }"},
      {"E: has no comment", "enum E {\n // X.\n E_UNSPECIFIED = 0;\n}"},
      {"E_UNSPECIFIED: has no comment", "// E.\nenum E { E_UNSPECIFIED = 0; }"},
      {"E_NONE: the value 0, and only it, is E_UNSPECIFIED",
       "// E.\nenum E {\n // X.\n E_NONE = 0;\n}"},
      {"KIND_UNSPECIFIED: its name must begin with TAXEL_KIND_",
       "// E.\nenum TaxelKind {\n // X.\n KIND_UNSPECIFIED = 0;\n}"},
      {"E_one: enum values are named",
       "// E.\nenum E {\n // X.\n E_UNSPECIFIED = 0;\n // Y.\n E_one = 1;\n}"},
      {"Things: services are named", "// A.\nservice Things {}"},
      {"AService: has no comment", "service AService {}"},
      {"AService.Do: has no comment",
       "// A.\nservice AService { rpc Do(DoRequest) returns (DoResponse); }"},
      {"AService.Do: uses Thing; it must be DoRequest",
       "// A.\nservice AService {\n // B.\n rpc Do(Thing) returns "
       "(DoResponse);\n}"},
      {"AService.Do: uses Thing; it must be DoResponse",
       "// A.\nservice AService {\n // B.\n rpc Do(DoRequest) returns "
       "(Thing);\n}"},
  };
  for (const BadProto& bad : cases) {
    EXPECT_THAT(Lint(ParseProto(kHead + bad.text)),
                Contains(HasSubstr(bad.complaint)))
        << bad.text;
  }
  EXPECT_THAT(Lint(ParseProto("syntax = \"proto3\";\npackage tactus.v1;\n")),
              Contains(HasSubstr("sample.proto: has no comment")));
  const auto elsewhere =
      Lint(ParseProto("// A.\nsyntax = \"proto3\";\npackage other.v1;\n"));
  EXPECT_THAT(elsewhere, Contains(HasSubstr("its folder is not that")));
  EXPECT_THAT(elsewhere, Contains(HasSubstr("must be tactus.v1")));
  FileDescriptorSet set;
  *set.add_file() = ParseProto(kHead + "service A { rpc B(C) returns (C); }");
  EXPECT_THAT(SharedMessages(set), Contains("C: is used by A.B and A.B"));
}

TEST(BreakingChangesTest, TheContractKeepsItsPromises) {
  EXPECT_THAT(BreakingChanges(Golden(), Current()), IsEmpty())
      << "Programs in use would break. Add new fields and RPCs instead; see "
         "docs/formats.md, \"Wire contract\".";
}

// A golden set that lags behind protects less than it seems to.
TEST(BreakingChangesTest, TheGoldenSetIsUpToDate) {
  const FileDescriptorSet all = Current();
  FileDescriptorSet current;
  for (const FileDescriptorProto& file : all.file()) {
    if (absl::StartsWith(file.name(), "google/")) continue;
    *current.add_file() = file;
  }
  EXPECT_THAT(BreakingChanges(current, Golden()), IsEmpty())
      << "The contract has grown. Renew the golden set in the project's root:\n"
         "  protoc -Iproto --descriptor_set_out=tests/golden/tactus_v1.desc "
         "proto/tactus/v1/*.proto";
}

DescriptorProto* FindMessage(FileDescriptorSet& set, const std::string& name) {
  for (FileDescriptorProto& file : *set.mutable_file()) {
    for (DescriptorProto& message : *file.mutable_message_type()) {
      if (message.name() == name) return &message;
    }
  }
  return nullptr;
}

FileDescriptorProto* FindFile(FileDescriptorSet& set, const std::string& name) {
  for (FileDescriptorProto& file : *set.mutable_file()) {
    if (file.name() == "tactus/v1/" + name + ".proto") return &file;
  }
  return nullptr;
}

struct Mutation {
  const char* complaint;
  std::function<void(FileDescriptorSet&)> apply;
};

TEST(BreakingChangesTest, EachMutationIsFound) {
  const auto frames = [](FileDescriptorSet& set) {
    return FindMessage(set, "FrameBatch");
  };
  const auto contact = [](FileDescriptorSet& set) {
    return FindFile(set, "contact")->mutable_service(0);
  };
  const Mutation mutations[] = {
      {"FrameBatch: number 1, ",
       [&](auto& set) { frames(set)->mutable_field()->DeleteSubrange(0, 1); }},
      {"FrameBatch: number 1, ",
       [&](auto& set) { frames(set)->mutable_field(0)->set_number(99); }},
      {"FrameBatch: number 1 was ",
       [&](auto& set) {
         frames(set)->mutable_field(0)->set_type(
             FieldDescriptorProto::TYPE_INT32);
       }},
      {"FrameBatch: number 1 was ",
       [&](auto& set) {
         frames(set)->mutable_field(0)->set_label(
             FieldDescriptorProto::LABEL_REPEATED);
       }},
      {"FrameBatch: number 1 was ",
       [&](auto& set) { frames(set)->mutable_field(0)->set_name("other"); }},
      {"StreamConfig: number 2 was ",
       [&](auto& set) {
         FindMessage(set, "StreamConfig")
             ->mutable_field(1)
             ->set_type_name(".tactus.v1.FrameBatch");
       }},
      {"ClassifyContactRequest: number 1 was ",
       [&](auto& set) {
         FindMessage(set, "ClassifyContactRequest")
             ->mutable_field(0)
             ->clear_oneof_index();
       }},
      {"FrameBatch: message is gone",
       [&](auto& set) { frames(set)->set_name("Frames"); }},
      {"StreamNotice.Kind: number 4, ",
       [&](auto& set) {
         FindMessage(set, "StreamNotice")
             ->mutable_enum_type(0)
             ->mutable_value()
             ->RemoveLast();
       }},
      {"ErrorReason: number 1 was ",
       [&](auto& set) {
         for (auto& type : *FindFile(set, "common")->mutable_enum_type()) {
           if (type.name() == "ErrorReason") {
             type.mutable_value(1)->set_name("ERROR_REASON_OTHER");
           }
         }
       }},
      {"ErrorReason: enum is gone",
       [&](auto& set) {
         FindFile(set, "common")->mutable_enum_type()->Clear();
       }},
      {"ContactService/ClassifyTrial: RPC is gone",
       [&](auto& set) { contact(set)->mutable_method()->RemoveLast(); }},
      {"ContactService/ClassifyContact: was ",
       [&](auto& set) {
         contact(set)->mutable_method(0)->set_server_streaming(false);
       }},
      {"ContactService/ClassifyContact: was ",
       [&](auto& set) {
         contact(set)->mutable_method(0)->set_client_streaming(false);
       }},
      {"ContactService/ClassifyTrial: was ",
       [&](auto& set) {
         contact(set)->mutable_method(1)->set_input_type(
             ".tactus.v1.FrameBatch");
       }},
      {"ContactService/ClassifyContact: RPC is gone",
       [&](auto& set) { contact(set)->set_name("TouchService"); }},
      {"FrameBatch: message is gone",
       [&](auto& set) { FindFile(set, "contact")->set_package("tactus.v2"); }},
  };
  const FileDescriptorSet golden = Golden();
  for (const Mutation& mutation : mutations) {
    FileDescriptorSet mutant = golden;
    mutation.apply(mutant);
    EXPECT_THAT(BreakingChanges(golden, mutant),
                Contains(HasSubstr(mutation.complaint)));
    EXPECT_THAT(BreakingChanges(golden, golden), IsEmpty());
  }
}

TEST(BreakingChangesTest, AdditionsAreAllowed) {
  const FileDescriptorSet golden = Golden();
  FileDescriptorSet grown = golden;
  auto* field = FindMessage(grown, "FrameBatch")->add_field();
  field->set_name("extra");
  field->set_number(100);
  FileDescriptorProto* contact = FindFile(grown, "contact");
  contact->mutable_service(0)->add_method()->set_name("New");
  contact->add_message_type()->set_name("New");
  EXPECT_THAT(BreakingChanges(golden, grown), IsEmpty());
  EXPECT_FALSE(BreakingChanges(grown, golden).empty());
}

}  // namespace
}  // namespace tactus::internal

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>

#include "absl/strings/match.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/examples/header_example.h"
#include "tests/house/house_rules.h"

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

std::string Root() {
  const char* root = std::getenv("TACTUS_SOURCE_DIR");
  return root == nullptr ? "." : root;
}

std::string ReadText(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  EXPECT_TRUE(in.good()) << path;
  return {std::istreambuf_iterator<char>(in), {}};
}

// Calls `check` with path from the root and text of every C++ file.
int ForEachSource(
    const std::function<void(const std::string&, const std::string&)>& check) {
  int files = 0;
  for (const char* top :
       {"core", "server", "client", "tools", "tests", "research", "examples"}) {
    if (!fs::exists(fs::path(Root()) / top)) continue;
    for (const auto& entry :
         fs::recursive_directory_iterator(fs::path(Root()) / top)) {
      const std::string extension = entry.path().extension();
      if (extension != ".cc" && extension != ".h") continue;
      check(fs::relative(entry.path(), Root()), ReadText(entry.path()));
      ++files;
    }
  }
  return files;
}

const std::vector<std::string> kRooms = {
    "base", "skin", "hmm", "data", "sim/model", "sim/exact", "sim"};

// The rooms of core and their parts ("sim/exact"), lowest first.
std::vector<std::string> RoomsAndParts() {
  const fs::path core = fs::path(Root()) / "core";
  std::vector<std::string> all;
  for (const std::string& room : CoreRooms(ReadText(core / "CMakeLists.txt"))) {
    const std::string text = ReadText(core / room / "CMakeLists.txt");
    for (const std::string& part : CoreRooms(text)) {
      all.push_back(room + "/" + part);
    }
    all.push_back(room);
  }
  return all;
}

TEST(HouseTest, ArrowsRunOneWay) {
  const std::vector<std::string> rooms = RoomsAndParts();
  EXPECT_GE(rooms.size(), 15u);
  const int files =
      ForEachSource([&](const std::string& path, const std::string& text) {
        EXPECT_THAT(IncludeViolations(path, text, rooms), IsEmpty());
      });
  EXPECT_GE(files, 20) << "is TACTUS_SOURCE_DIR the project's root?";
}

TEST(HouseTest, FilesAreSmallAndTidy) {
  ForEachSource([](const std::string& path, const std::string& text) {
    EXPECT_THAT(StyleViolations(path, text), IsEmpty());
  });
}

// A folder with code has a line there, or lies in one that has.
TEST(HouseTest, TheMapNamesEveryRoom) {
  const std::vector<std::string> named =
      RoomsNamed(ReadText(fs::path(Root()) / "ARCHITECTURE.md"));
  for (const std::string& room : named) {
    EXPECT_TRUE(fs::is_directory(fs::path(Root()) / room)) << room;
  }
  ForEachSource([&](const std::string& path, const std::string&) {
    if (absl::StartsWith(path, "tests/")) return;
    const std::string folder = fs::path(path).parent_path();
    EXPECT_TRUE(std::ranges::any_of(
        named,
        [&](const std::string& room) {
          return folder == room || absl::StartsWith(folder, room + "/");
        }))
        << path << ": ARCHITECTURE.md does not say what is in its folder";
  });
}

TEST(HouseTest, ThreadSanitizerSeesEveryRoomOfCoreThatHasThreads) {
  const std::vector<std::string> tested = FoldersUnderThreadSanitizer(
      ReadText(fs::path(Root()) / "tests/CMakeLists.txt"));
  EXPECT_THAT(tested, Contains("core/train"));
  ForEachSource([&](const std::string& path, const std::string& text) {
    EXPECT_THAT(ThreadViolations(path, text, tested), IsEmpty());
  });
}

TEST(HouseTest, PagesNameFilesThatExist) {
  std::vector<fs::path> pages;
  for (const char* folder : {"", "docs", "research", "research/results"}) {
    for (const auto& entry :
         fs::directory_iterator(fs::path(Root()) / folder)) {
      if (entry.path().extension() == ".md") pages.push_back(entry.path());
    }
  }
  EXPECT_GE(pages.size(), 10u);
  for (const fs::path& page : pages) {
    const std::string path = fs::relative(page, Root());
    for (const std::string& file : FilesNamed(path, ReadText(page))) {
      EXPECT_TRUE(fs::exists(fs::path(Root()) / file)) << path << ": " << file;
    }
  }
}

TEST(HouseTest, TheFirstClientIsPrintedAsItIsBuilt) {
  const std::string page =
      ReadText(fs::path(Root()) / "docs/your-first-client.md");
  const std::pair<const char*, const char*> files[] = {
      {"cmake", "first_client/CMakeLists.txt"},
      {"cpp", "first_client/first_client.cc"},
      {"python", "first_client/first_client.py"},
      {"cmake", "in_process/CMakeLists.txt"},
      {"cpp", "in_process/in_process.cc"}};
  for (const auto& [language, name] : files) {
    const std::string text = ReadText(fs::path(Root()) / "examples" / name);
    EXPECT_THAT(page,
                HasSubstr(std::string("```") + language + "\n" + text + "```"))
        << name;
  }
}

// tests/examples compiles them; a "-inl.h" has no meaning without Highway.
TEST(HouseTest, ExamplesAreCompiled) {
  std::string compiled;
  for (const auto& entry :
       fs::directory_iterator(fs::path(Root()) / "tests/examples")) {
    if (entry.path().extension() != ".cc") continue;
    compiled += ReadText(entry.path());
  }
  int headers = 0;
  ForEachSource([&](const std::string& path, const std::string& text) {
    if (!absl::EndsWith(path, ".h") || absl::EndsWith(path, "-inl.h") ||
        absl::StartsWith(path, "tests/") || absl::StartsWith(path, "tools/") ||
        HeaderExample(text).empty()) {
      return;
    }
    ++headers;
    const std::string line = "#include \"" + path + ".inc\"";
    EXPECT_TRUE(absl::StrContains(compiled, "\n" + line + "\n"))
        << path << ": nothing compiles its example; add to a file of "
        << "tests/examples, in a function that has what it needs:\n"
        << line;
  });
  EXPECT_GE(headers, 100);
}

TEST(ExampleRuleTest, CodeIsTakenAsItStands) {
  EXPECT_EQ(HeaderExample("// File: a.h\n//\n// A class:\n//\n"
                          "//   A a(1,\n//       2);  // two\n//   a.Run();\n"
                          "//\n//   a.Stop();\n//\n"
                          "// - a list;\n//   its second line;\n//\n"
                          "//   y = f(x)  // no code;\n//\n// The end.\n"
                          "#pragma once\n//\n//   int not_this;\n//\n"),
            "   A a(1,\n       2);  // two\n   a.Run();\n\n   a.Stop();\n");
}

TEST(ExampleRuleTest, TheCommentMayEndWithTheCode) {
  EXPECT_EQ(HeaderExample("// File: a.h\n//\n//   A a;\n#pragma once\n"),
            "   A a;\n");
  EXPECT_EQ(HeaderExample("// File: a.h\n//\n//   A a;"), "   A a;\n");
  EXPECT_EQ(HeaderExample("// File: a.h\n#pragma once\n"), "");
}

TEST(PageRuleTest, LinksAndPathsAreFound) {
  EXPECT_THAT(FilesNamed("docs/a.md",
                         "[b](b.md#there) ![c](pictures/c.png) [d](../D.md)\n"
                         "[e](https://e.org/e.md) [f](#here)\n"
                         "`core/g.h` `core/` `g.h` `docs/h.sh`\n"
                         "```cpp\n[](int x) { return x; }\n```\n"),
              ElementsAre("docs/b.md", "docs/pictures/c.png", "D.md",
                          "core/g.h", "docs/h.sh"));
}

TEST(PageRuleTest, RoomsAreTheFirstCells) {
  EXPECT_THAT(RoomsNamed("| room | what |\n|---|---|\n| `core/hmm`, `core/a` | "
                         "`x.h` |\n`core/b`\n"),
              ElementsAre("core/hmm", "core/a"));
}

TEST(IncludeRuleTest, RoomsComeFromTheirList) {
  EXPECT_THAT(CoreRooms("find_package(absl)\nadd_subdirectory(base)\n"
                        "if(X)\n  add_subdirectory(data)\nendif()\n"),
              ElementsAre("base", "data"));
}

TEST(IncludeRuleTest, WhatIsAllowedPasses) {
  const std::pair<const char*, const char*> allowed[] = {
      {"core/hmm/a.cc", "#include \"core/hmm/a.h\""},
      {"core/hmm/a.cc", "#include \"core/base/errors.h\""},
      {"core/hmm/a.cc", "#include <vector>"},
      {"core/hmm/a.cc", "// #include \"server/main.h\""},
      // The plain type is open to the rooms below data as well.
      {"core/hmm/a.cc", "#include \"core/data/trial.h\""},
      {"core/files/a.cc", "#include <fstream>"},
      {"core/data/a.cc", "#include <fstream>"},
      {"core/import/a.cc", "#include <filesystem>"},
      {"core/store/a.cc", "#include <mutex>"},
      {"core/base/run_on_threads.cc", "#include <thread>"},
      {"core/sim/exact/a.cc", "#include \"core/sim/model/a.h\""},
      {"core/sim/exact/a.cc", "#include \"core/sim/exact/a.h\""},
      {"core/sim/model/a.cc", "#include \"core/hmm/a.h\""},
      {"core/base/a.cc", "#include \"tactus/v1/common.pb.h\""},
      {"server/rpc/a.cc", "#include \"core/hmm/a.h\""},
      {"server/rpc/a.cc", "#include \"server/session/a.h\""},
      {"server/rpc/a.cc", "#include <grpcpp/grpcpp.h>"},
      {"client/a.cc", "#include \"core/sim/a.h\""},
      {"tests/client/a.cc", "#include \"server/rpc/a.h\""},
      {"tools/load/a.cc", "#include \"tools/load/b.h\""},
      {"client/include/tactus/a.h", "#include <vector>"},
      {"client/include/tactus/a.h", "#include \"absl/status/statusor.h\""},
      {"client/include/tactus/a.h", "#include \"tactus/b.h\""},
  };
  for (const auto& [path, line] : allowed) {
    EXPECT_THAT(IncludeViolations(path, line, kRooms), IsEmpty());
  }
}

TEST(IncludeRuleTest, EachWrongArrowIsFound) {
  struct Case {
    const char* path;
    const char* line;
    const char* why;
  };
  const Case cases[] = {
      {"core/hmm/a.cc", "#include \"server/session/a.h\"", "neither server"},
      {"core/hmm/a.cc", "#include \"client/a.h\"", "neither server"},
      {"core/hmm/a.h", "#include <grpcpp/grpcpp.h>", "no gRPC"},
      {"core/data/a.h", "#include <grpc/grpc.h>", "no gRPC"},
      {"core/hmm/a.h", "# include \"tactus/v1/contact.grpc.pb.h\"", "no gRPC"},
      {"core/hmm/a.h", "#include \"core/sim/a.h\"", "room sim is not below"},
      {"core/hmm/a.h", "#include \"core/data/trial_file.h\"",
       "room data is not below"},
      {"core/moon/a.h", "#include \"core/hmm/a.h\"", "not in core/CMakeLists"},
      {"core/hmm/a.h", "#include \"core/moon/a.h\"", "room moon is not below"},
      {"core/sim/model/a.h", "#include \"core/sim/exact/a.h\"",
       "room sim/exact is not below room sim/model"},
      {"core/hmm/a.h", "#include \"core/sim/model/a.h\"",
       "room sim is not below room hmm"},
      {"core/hmm/a.cc", "#include <thread>", "no threads"},
      {"core/hmm/a.cc", "#include <mutex>", "no threads"},
      {"core/hmm/a.cc", "#include <chrono>", "no threads"},
      {"core/base/a.cc", "#include <fstream>", "no threads"},
      {"core/sim/a.cc", "#include <filesystem>", "no threads"},
      {"core/sim/a.cc", "  #include <iostream>", "no threads"},
      {"server/rpc/a.cc", "#include \"client/a.h\"", "does not know client"},
      {"client/a.cc", "#include \"server/rpc/a.h\"", "does not know server"},
      {"client/stream/a.cc", "#include \"tools/load/a.h\"",
       "only tools know tools"},
      {"core/hmm/a.cc", "#include \"tools/load/a.h\"", "only tools know tools"},
      {"tools/load/a.cc", "#include \"server/rpc/a.h\"", "do not know server"},
      {"server/session/a.cc", "#include <grpcpp/grpcpp.h>", "session/ knows"},
      {"server/jobs/a.cc", "#include <grpcpp/grpcpp.h>", "jobs/ knows"},
      {"server/names/a.cc", "#include \"server/rpc/a.h\"", "names/ knows"},
      {"core/hmm/a.cc", "#include \"tests/a.h\"", "only tests"},
      {"client/include/tactus/a.h", "#include \"core/base/a.h\"",
       "public headers"},
      {"client/include/tactus/a.h", "#include \"tactus/v1/contact.pb.h\"",
       "public headers"},
      {"client/include/tactus/a.h", "#include <grpcpp/channel.h>",
       "public headers"},
      {"client/include/tactus/a.h", "#include \"Eigen/Core\"",
       "public headers"},
      {"client/include/tactus/a.h", "#include <unistd.h>", "public headers"},
  };
  for (const Case& c : cases) {
    EXPECT_THAT(
        IncludeViolations(c.path, std::string("\n") + c.line + "\n", kRooms),
        ElementsAre(HasSubstr(c.why)))
        << c.path << " " << c.line;
  }
  EXPECT_THAT(
      IncludeViolations("client/a.cc", "\n#include \"server/a.h\"\n", kRooms),
      ElementsAre(HasSubstr("client/a.cc:2: server/a.h: ")));
}

TEST(ThreadRuleTest, ARoomWithThreadsThatIsLeftOutIsFound) {
  const std::vector<std::string> tested = FoldersUnderThreadSanitizer(
      "set(test_dirs core/base\n  core/train)\n"
      "# ThreadSanitizer has nothing to see elsewhere.\n"
      "list(APPEND test_dirs core/lstm)\n");
  EXPECT_THAT(tested, Contains("core/base"));
  EXPECT_THAT(tested, Contains("core/train"));
  EXPECT_THAT(tested, Not(Contains("core/lstm")));
  for (const char* line : {"#include <thread>", "# include <atomic>",
                           "#include \"absl/synchronization/mutex.h\"",
                           "#include \"core/base/run_on_threads.h\"",
                           "#include \"core/base/work.h\""}) {
    EXPECT_THAT(ThreadViolations("core/train/a.cc", line, tested), IsEmpty());
    EXPECT_THAT(ThreadViolations("server/rpc/a.cc", line, tested), IsEmpty());
    EXPECT_THAT(ThreadViolations("core/lstm/a.cc", line, tested),
                ElementsAre(HasSubstr("core/lstm")))
        << line;
  }
  EXPECT_THAT(ThreadViolations("core/lstm/a.cc", "#include <vector>", tested),
              IsEmpty());
}

std::string ManyLines(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "int x;\n";
  return text;
}

TEST(StyleRuleTest, EachRuleCanFail) {
  const std::string header = "// File: a.h\n#pragma once\n";
  EXPECT_THAT(StyleViolations("core/hmm/a.h", header), IsEmpty());
  EXPECT_THAT(StyleViolations("core/hmm/a.cc", ManyLines(600)), IsEmpty());
  EXPECT_THAT(StyleViolations("core/hmm/a.cc", ManyLines(601)),
              ElementsAre(HasSubstr("has 601 lines")));
  EXPECT_THAT(StyleViolations("server/rpc/a.cc", ManyLines(300)), IsEmpty());
  EXPECT_THAT(StyleViolations("server/rpc/a.cc", ManyLines(301)),
              ElementsAre(HasSubstr("the limit is 300")));
  EXPECT_THAT(StyleViolations("core/a.cc", std::string("\n// TO") + "DO: x\n"),
              ElementsAre(HasSubstr("core/a.cc:2")));
  EXPECT_THAT(StyleViolations("core/a.cc", std::string("// FIX") + "ME\n"),
              ElementsAre(HasSubstr("core/a.cc:1")));
  const std::string in_public = "\nnamespace tactus {\n";
  EXPECT_THAT(StyleViolations("client/front/a.cc", in_public), IsEmpty());
  EXPECT_THAT(StyleViolations("core/a.cc", in_public),
              ElementsAre(HasSubstr("a.cc:2: what is not installed")));
  EXPECT_THAT(
      StyleViolations("core/a.cc", std::string("int x;\n  // O") + "f y.\n"),
      ElementsAre(HasSubstr("core/a.cc:2: a comment names")));
  EXPECT_THAT(StyleViolations("core/a.cc", "// " + std::string(78, 'x') + "\n"),
              ElementsAre(HasSubstr("has 81 columns")));
  EXPECT_THAT(StyleViolations("client/a.cc", "out << json.dump();\n"),
              ElementsAre(HasSubstr("JsonText()")));
  EXPECT_THAT(StyleViolations("core/a.cc",
                              std::string("std::ran") + "ges::unique(a);\n"),
              ElementsAre(HasSubstr("clang 14")));
  EXPECT_THAT(StyleViolations("core/hmm/b.h", header),
              Contains(HasSubstr("must begin with // File: b.h")));
  EXPECT_THAT(StyleViolations("core/hmm/a.h", ""),
              Contains(HasSubstr("must begin with")));
  EXPECT_THAT(StyleViolations("core/hmm/a.h", "// File: a.h\n"),
              ElementsAre(HasSubstr("no #pragma once")));
}

}  // namespace
}  // namespace tactus::internal

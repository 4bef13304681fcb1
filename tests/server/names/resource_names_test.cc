#include "server/names/resource_names.h"

#include "core/base/errors.h"
#include "core/base/text.h"
#include "gtest/gtest.h"

namespace tactus::internal::server {
namespace {

TEST(ResourceNamesTest, GoodNames) {
  struct Case {
    const char* name;
    const char* collection;
    const char* id;
    uint32_t version;
    const char* key;
  };
  const Case cases[] = {
      {"datasets/grasps", "datasets", "grasps", 0, "grasps"},
      {"datasets/a-1/versions/2", "datasets", "a-1", 2, "a-1/0000000002"},
      {"models/0/versions/2000000000", "models", "0", 2'000'000'000,
       "0/2000000000"},
      {"uploads/1", "uploads", "1", 0, "0000000001"},
      {"operations/2000000000", "operations", "2000000000", 0, "2000000000"},
      {"aliases/versions", "aliases", "versions", 0, "versions"},
      {"models/versions/versions/1", "models", "versions", 1,
       "versions/0000000001"},
      {"datasets/-", "datasets", "-", 0, "-"}};
  for (const Case& c : cases) {
    const auto name = ParseName(c.name, c.collection);
    ASSERT_TRUE(name.ok()) << name.status();
    EXPECT_EQ(name->id, c.id);
    EXPECT_EQ(name->version, c.version);
    EXPECT_EQ(name->ToString(), c.name);
    EXPECT_EQ(CatalogKey(*name), c.key);
    EXPECT_EQ(ParseVersionName(c.name, c.collection).ok(), c.version != 0);
  }
  EXPECT_TRUE(ParseName("models/" + std::string(64, 'a'), "models").ok());
}

TEST(ResourceNamesTest, BadNames) {
  const std::pair<std::string, const char*> cases[] = {
      {"", "datasets"},
      {"datasets", "datasets"},
      {"datasets/", "datasets"},
      {"/datasets/a", "datasets"},
      {"datasets//a", "datasets"},
      {"datasets/a/", "datasets"},
      {"models/a", "datasets"},
      {"Datasets/a", "datasets"},
      {"datasets/..", "datasets"},
      {"datasets/.", "datasets"},
      {"datasets/../a", "datasets"},
      {"datasets/a/../b", "datasets"},
      {"datasets/a/b", "datasets"},
      {"datasets/a\\b", "datasets"},
      {"datasets/a b", "datasets"},
      {"datasets/a.b", "datasets"},
      {"datasets/a_b", "datasets"},
      {"datasets/A", "datasets"},
      {"datasets/a%2fb", "datasets"},
      {"datasets/a\n", "datasets"},
      {std::string("datasets/a\0b", 12), "datasets"},
      {"datasets/\xff\xfe", "datasets"},
      {"datasets/\xc3\xa9", "datasets"},
      {"datasets/" + std::string(65, 'a'), "datasets"},
      {"datasets/" + std::string(100'000, 'a'), "datasets"},
      {"datasets/a/versions/", "datasets"},
      {"datasets/a/versions/0", "datasets"},
      {"datasets/a/versions/01", "datasets"},
      {"datasets/a/versions/-1", "datasets"},
      {"datasets/a/versions/+1", "datasets"},
      {"datasets/a/versions/1 ", "datasets"},
      {"datasets/a/versions/1x", "datasets"},
      {"datasets/a/versions/2000000001", "datasets"},
      {"datasets/a/versions/99999999999999999999", "datasets"},
      {"datasets/a/versions/1/versions/1", "datasets"},
      {"datasets//versions/1", "datasets"},
      {"aliases/a/versions/1", "aliases"},
      {"uploads/a", "uploads"},
      {"uploads/0", "uploads"},
      {"uploads/01", "uploads"},
      {"uploads/1/versions/1", "uploads"},
      {"uploads/1\n", "uploads"},
      {"operations/1 ", "operations"},
      {"uploads/../../etc/passwd", "uploads"},
      {"operations/1e3", "operations"},
      {"operations/ 1", "operations"},
      {"operations/2000000001", "operations"}};
  EXPECT_GE(std::size(cases), 30u);
  for (const auto& [name, collection] : cases) {
    const auto parsed = ParseName(name, collection);
    EXPECT_EQ(ReasonOf(parsed.status()), "INVALID_NAME") << name.substr(0, 99);
    EXPECT_EQ(ReasonOf(ParseVersionName(name, collection).status()),
              "INVALID_NAME");
    // The error is short, and text on one line.
    const std::string message(parsed.status().message());
    EXPECT_EQ(TextFault(message, 500), "") << message;
  }
}

TEST(ResourceNamesTest, NumbersSortByTheirValue) {
  EXPECT_LT(NumberKey(2), NumberKey(10));
  EXPECT_LT(NumberKey(999'999'999), NumberKey(1'000'000'000));
}

}  // namespace
}  // namespace tactus::internal::server

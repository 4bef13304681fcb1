// Damages a tokens file. What is read must find each of its entries again.
#include "core/access/access_table.h"
#include "tests/fuzz/damaged.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace tactus;
  static const auto* const good = new std::vector<std::string>{
      "# comment\n\narm-7 robot "
      "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08\n"
      "certificate lab-pc.example trainer\n"
      "boss admin "
      "60303ae22b998861bce3b28f33eec1be758a213c86c93c076dbe9f558c11c752\n"};
  FuzzedDataProvider data(bytes, size);
  const auto table = AccessTable::Parse(fuzz::Damaged(*good, data));
  fuzz::RequireReason(table.status());
  // The good file is good.
  REQUIRE(size > 0 || table.ok());
  if (!table.ok()) return 0;
  const size_t entries = table->tokens().size() + table->certificates().size();
  REQUIRE(entries >= 1 && entries <= AccessTable::kMaxEntries);
  for (const auto& token : table->tokens()) {
    REQUIRE(token.digest.size() == 32);
    REQUIRE(!token.entry.name.empty());
  }
  for (const auto& [name, entry] : table->certificates()) {
    REQUIRE(table->FindCertificate(name) == &entry);
  }
  REQUIRE(table->FindToken("") == nullptr);
  return 0;
}

// File: catalog_access.h
//
// Single records of a catalogue, for tests.
//
//   ASSERT_TRUE(Put(*catalog, "a", "1").ok());
//   EXPECT_EQ(Get(*catalog, "a"), "1");
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/base/status_macros.h"
#include "core/store/catalog.h"
#include "gtest/gtest.h"

namespace tactus::internal::testing {

inline absl::Status Put(Catalog& catalog, const std::string& key,
                        const std::string& value,
                        Table table = Table::kTrials) {
  return catalog.Change(
      [&](Transaction& change) { return change.Put(table, key, value); });
}

// Nothing after an error, which `status` receives.
inline std::vector<CatalogEntry> Scan(const Catalog& catalog,
                                      const ScanOptions& options = {},
                                      Table table = Table::kTrials,
                                      absl::Status* status = nullptr) {
  std::vector<CatalogEntry> entries;
  const absl::Status looked =
      catalog.Look([&](const Transaction& look) -> absl::Status {
        TACTUS_ASSIGN_OR_RETURN(entries, look.Scan(table, options));
        return absl::OkStatus();
      });
  if (status == nullptr) {
    EXPECT_TRUE(looked.ok()) << looked;
  } else {
    *status = looked;
  }
  return entries;
}

inline std::vector<std::string> Keys(const Catalog& catalog,
                                     const ScanOptions& options) {
  std::vector<std::string> keys;
  for (const CatalogEntry& entry : Scan(catalog, options)) {
    keys.push_back(entry.key);
  }
  return keys;
}

inline std::optional<std::string> Get(const Catalog& catalog,
                                      const std::string& key,
                                      Table table = Table::kTrials) {
  std::optional<std::string> value;
  EXPECT_TRUE(catalog
                  .Look([&](const Transaction& look) {
                    auto got = look.Get(table, key);
                    if (got.ok()) value = *got;
                    return got.status();
                  })
                  .ok());
  return value;
}

}  // namespace tactus::internal::testing

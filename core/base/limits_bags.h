// File: limits_bags.h
//
// Limits of bags of ROS 2. Thread-safe: constants.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tactus::internal::limits {

// Files of one bag, its topics, and its messages.
inline constexpr size_t kMaxBagFiles = 1'000;
inline constexpr size_t kMaxBagTopics = 1'000;
inline constexpr uint64_t kMaxBagMessages = 100'000'000;
// Bytes of one message: those of an MCAP record.
inline constexpr size_t kMaxBagMessageBytes = 64UL * 1024 * 1024;
// Numbers of one message, and its fields and elements that are no numbers. So a
// type that nests empty lists takes little time.
inline constexpr size_t kMaxBagNumbers = 8'000'000;
inline constexpr size_t kMaxBagSteps = 1'000'000;
// Bytes of a type's definition, fields of a type, bytes of a field's name, and
// types within types.
inline constexpr size_t kMaxBagDefinitionBytes = 1024 * 1024;
inline constexpr size_t kMaxBagFields = 10'000;
inline constexpr size_t kMaxBagNameBytes = 256;
inline constexpr int kMaxBagDepth = 16;
// Bytes of a text of a message that is kept.
inline constexpr size_t kMaxBagTextBytes = 256;
// Steps of SQLite's machine for one .db3 file; a message takes some ten.
inline constexpr int64_t kMaxBagQuerySteps = 4'000'000'000;

}  // namespace tactus::internal::limits

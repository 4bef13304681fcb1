#include "core/files/npz.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/strip.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/file_bytes.h"

namespace tactus::internal {
namespace {

static_assert(std::endian::native == std::endian::little,
              "numbers are copied as they lie in the file");

constexpr absl::string_view kEnding = ".npy";
// Signatures of the three kinds of record that an archive has.
constexpr uint32_t kLocalFile = 0x04034B50;
constexpr uint32_t kCentralFile = 0x02014B50;
constexpr uint32_t kEndOfDirectory = 0x06054B50;
// Bytes of each before its texts.
constexpr size_t kLocalBytes = 30;
constexpr size_t kCentralBytes = 46;
constexpr size_t kEndBytes = 22;
constexpr size_t kMaxCommentBytes = 65'535;
constexpr uint16_t kStored = 0;
constexpr uint16_t kDeflated = 8;
// 1 January 1980, the first day that the format knows.
constexpr uint16_t kDate = 1 << 5 | 1;
constexpr uint16_t kVersion = 20;
constexpr uint16_t kUtf8Names = 1 << 11;
constexpr size_t kMaxEntries = 65'535;
constexpr size_t kMaxArchiveBytes = UINT32_MAX;
// Best ratio that deflate can reach.
constexpr size_t kMaxNpzCompression = 1100;
// A size or an offset with this value lies in the zip64 field.
constexpr size_t kInZip64 = UINT32_MAX;

template <typename Number>
Number At(absl::string_view bytes, size_t offset) {
  Number value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

void Append16(size_t value, std::string* out) {
  out->push_back(static_cast<char>(value % 256));
  out->push_back(static_cast<char>(value / 256 % 256));
}

void Append32(size_t value, std::string* out) {
  Append16(value % 65536, out);
  Append16(value / 65536, out);
}

uint32_t Crc32(absl::string_view bytes) {
  return static_cast<uint32_t>(
      crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

// An entry of the central directory.
struct Entry {
  std::string name;
  uint16_t flags = 0;
  uint16_t method = 0;
  uint32_t crc = 0;
  size_t packed_bytes = 0;
  size_t bytes = 0;
  size_t offset = 0;
};

// Replaces the sizes that did not fit into 32 bits.
void TakeZip64(absl::string_view extra, Entry* entry) {
  while (extra.size() >= 4) {
    const size_t size = At<uint16_t>(extra, 2);
    absl::string_view field = extra.substr(4, size);
    if (At<uint16_t>(extra, 0) == 1) {
      for (size_t* value :
           {&entry->bytes, &entry->packed_bytes, &entry->offset}) {
        if (*value == kInZip64 && field.size() >= 8) {
          *value = At<uint64_t>(field, 0);
          field.remove_prefix(8);
        }
      }
    }
    extra.remove_prefix(std::min(4 + size, extra.size()));
  }
}

// Where the central directory begins, and how many entries it has.
struct Directory {
  size_t offset = 0;
  size_t entries = 0;
};

absl::StatusOr<Directory> FindDirectory(absl::string_view path,
                                        absl::string_view bytes) {
  if (bytes.size() >= kEndBytes) {
    const size_t last = bytes.size() - kEndBytes;
    const size_t first = last - std::min(last, kMaxCommentBytes);
    for (size_t at = last + 1; at-- > first;) {
      if (At<uint32_t>(bytes, at) != kEndOfDirectory) continue;
      return Directory{At<uint32_t>(bytes, at + 16),
                       At<uint16_t>(bytes, at + 10)};
    }
  }
  return TrialFileInvalid(path,
                          "is not a whole .npz file: its directory is missing");
}

absl::StatusOr<std::vector<Entry>> ReadDirectory(absl::string_view path,
                                                 absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(const Directory directory,
                          FindDirectory(path, bytes));
  std::vector<Entry> entries;
  size_t at = directory.offset;
  for (size_t i = 0; i < directory.entries; ++i) {
    if (at > bytes.size() || bytes.size() - at < kCentralBytes ||
        At<uint32_t>(bytes, at) != kCentralFile) {
      return TrialFileInvalid(path, "its directory is damaged");
    }
    const size_t name_bytes = At<uint16_t>(bytes, at + 28);
    const size_t extra = At<uint16_t>(bytes, at + 30);
    const size_t more = extra + At<uint16_t>(bytes, at + 32);
    if (bytes.size() - at - kCentralBytes < name_bytes + more) {
      return TrialFileInvalid(path, "its directory is damaged");
    }
    Entry& entry = entries.emplace_back(
        Entry{std::string(bytes.substr(at + kCentralBytes, name_bytes)),
              At<uint16_t>(bytes, at + 8), At<uint16_t>(bytes, at + 10),
              At<uint32_t>(bytes, at + 16), At<uint32_t>(bytes, at + 20),
              At<uint32_t>(bytes, at + 24), At<uint32_t>(bytes, at + 42)});
    TakeZip64(bytes.substr(at + kCentralBytes + name_bytes, extra), &entry);
    at += kCentralBytes + name_bytes + more;
  }
  return entries;
}

// False unless `packed` is one whole deflate stream of out->size() bytes.
bool Inflate(absl::string_view packed, std::string* out) {
  z_stream stream = {};
  // Negative: without zlib's header.
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) return false;
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  stream.avail_in = static_cast<uInt>(packed.size());
  stream.next_out = reinterpret_cast<Bytef*>(out->data());
  stream.avail_out = static_cast<uInt>(out->size());
  const int result = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  return result == Z_STREAM_END && stream.avail_out == 0 &&
         stream.avail_in == 0;
}

absl::StatusOr<std::string> Unpack(absl::string_view path,
                                   absl::string_view bytes,
                                   const Entry& entry) {
  if ((entry.flags & 1) != 0 ||
      (entry.method != kStored && entry.method != kDeflated)) {
    return TrialFileInvalid(
        path, absl::StrCat("is packed by method ", entry.method,
                           (entry.flags & 1) != 0 ? " and encrypted" : "",
                           "; use numpy.savez or numpy.savez_compressed"));
  }
  const absl::Status damaged =
      TrialFileInvalid(path, "is cut short or damaged");
  if (entry.offset > bytes.size() ||
      bytes.size() - entry.offset < kLocalBytes ||
      At<uint32_t>(bytes, entry.offset) != kLocalFile) {
    return damaged;
  }
  const absl::string_view rest = bytes.substr(entry.offset + kLocalBytes);
  const size_t texts = At<uint16_t>(bytes, entry.offset + 26) +
                       size_t{At<uint16_t>(bytes, entry.offset + 28)};
  if (rest.size() < texts || rest.size() - texts < entry.packed_bytes ||
      entry.bytes > limits::kMaxTrialArrayBytes ||
      entry.bytes / kMaxNpzCompression > entry.packed_bytes) {
    return damaged;
  }
  const absl::string_view packed = rest.substr(texts, entry.packed_bytes);
  std::string content(entry.bytes, '\0');
  if (entry.method == kDeflated) {
    if (!Inflate(packed, &content)) return damaged;
  } else {
    if (packed.size() != content.size()) return damaged;
    content = std::string(packed);
  }
  if (Crc32(content) != entry.crc) return damaged;
  return content;
}

}  // namespace

absl::StatusOr<NpzArrays> ParseNpz(absl::string_view path,
                                   absl::string_view bytes) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Entry> entries,
                          ReadDirectory(path, bytes));
  NpzArrays arrays;
  size_t total = 0;
  for (const Entry& entry : entries) {
    const std::string where = absl::StrCat(path, ": array ", entry.name);
    total += entry.bytes;
    if (total > limits::kMaxTrialArrayBytes) {
      return TrialFileInvalid(
          path, absl::StrCat("its arrays have more than ",
                             limits::kMaxTrialArrayBytes, " bytes"));
    }
    absl::string_view name = entry.name;
    if (!absl::ConsumeSuffix(&name, kEnding)) {
      return TrialFileInvalid(where, "is not a .npy array");
    }
    TACTUS_ASSIGN_OR_RETURN(const std::string content,
                            Unpack(where, bytes, entry));
    TACTUS_ASSIGN_OR_RETURN(NpyArray array, ParseNpy(where, content));
    if (!arrays.emplace(name, std::move(array)).second) {
      return TrialFileInvalid(where, "is there twice");
    }
  }
  return arrays;
}

absl::StatusOr<NpzArrays> ReadNpz(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxTrialArrayBytes));
  return ParseNpz(path, bytes);
}

absl::StatusOr<NpyArray> ParseNpz(absl::string_view path,
                                  absl::string_view bytes,
                                  absl::string_view name) {
  TACTUS_ASSIGN_OR_RETURN(const std::vector<Entry> entries,
                          ReadDirectory(path, bytes));
  std::vector<std::string> names;
  const Entry* found = nullptr;
  for (const Entry& entry : entries) {
    const absl::string_view stem = absl::StripSuffix(entry.name, kEnding);
    if (name == entry.name || name == stem) found = &entry;
    names.push_back(Printable(stem));
  }
  if (name.empty() && entries.size() == 1) found = &entries.front();
  if (found == nullptr) {
    return TrialFileInvalid(
        path,
        absl::StrCat(name.empty() ? std::string("holds several arrays")
                                  : absl::StrCat("has no array ", Quoted(name)),
                     "; name one of ", absl::StrJoin(names, ", ")));
  }
  const std::string where = absl::StrCat(path, ": array ", found->name);
  TACTUS_ASSIGN_OR_RETURN(const std::string content,
                          Unpack(where, bytes, *found));
  return ParseNpy(where, content);
}

absl::StatusOr<NpyArray> ReadNpz(const std::string& path,
                                 absl::string_view name) {
  TACTUS_ASSIGN_OR_RETURN(const std::string bytes,
                          ReadFileBytes(path, limits::kMaxTrialArrayBytes));
  return ParseNpz(path, bytes, name);
}

absl::StatusOr<std::string> NpzBytes(
    const std::vector<std::pair<std::string, std::string>>& arrays) {
  std::string bytes;
  std::string directory;
  size_t total = 0;
  for (const auto& [name, content] : arrays) {
    total += content.size() + 2 * (name.size() + kEnding.size()) + kLocalBytes +
             kCentralBytes;
  }
  if (arrays.size() > kMaxEntries || total >= kMaxArchiveBytes - kEndBytes) {
    return TrialFileInvalid(
        ".npz file",
        absl::StrCat("would have ", arrays.size(), " arrays and ", total,
                     " bytes; at most ", kMaxEntries, " arrays and 4 GiB fit"));
  }
  for (const auto& [name, content] : arrays) {
    const size_t offset = bytes.size();
    const std::string file = absl::StrCat(name, kEnding);
    // The fields that local header and directory have in common.
    std::string common;
    Append16(kVersion, &common);
    Append16(kUtf8Names, &common);
    Append16(kStored, &common);
    Append16(0, &common);  // midnight
    Append16(kDate, &common);
    Append32(Crc32(content), &common);
    Append32(content.size(), &common);
    Append32(content.size(), &common);
    Append16(file.size(), &common);
    Append16(0, &common);  // no extra fields
    Append32(kLocalFile, &bytes);
    absl::StrAppend(&bytes, common, file, content);
    Append32(kCentralFile, &directory);
    Append16(kVersion, &directory);
    directory += common;
    // No comment, disk 0, no attributes.
    directory.append(10, '\0');
    Append32(offset, &directory);
    directory += file;
  }
  const size_t directory_offset = bytes.size();
  bytes += directory;
  Append32(kEndOfDirectory, &bytes);
  Append32(0, &bytes);  // disk 0
  Append16(arrays.size(), &bytes);
  Append16(arrays.size(), &bytes);
  Append32(directory.size(), &bytes);
  Append32(directory_offset, &bytes);
  Append16(0, &bytes);  // no comment
  return bytes;
}

}  // namespace tactus::internal

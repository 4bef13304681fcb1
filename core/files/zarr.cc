#include "core/files/zarr.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <system_error>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "core/base/errors.h"
#include "core/base/limits.h"
#include "core/base/status_macros.h"
#include "core/base/text.h"
#include "core/files/draft_file.h"
#include "core/files/file_bytes.h"
#include "core/files/npy.h"
#include "core/files/npy_write.h"
#include "nlohmann/json.hpp"

namespace tactus::internal {
namespace {

namespace fs = std::filesystem;
// Keeps the order of its keys.
using ZarrJson = nlohmann::ordered_json;

constexpr char kGroupFile[] = ".zgroup";
constexpr char kArrayFile[] = ".zarray";
constexpr char kAttributesFile[] = ".zattrs";
constexpr char kVersion3File[] = "zarr.json";
constexpr char kGroupText[] = "{\n    \"zarr_format\": 2\n}";
constexpr size_t kMaxJsonBytes = 1 << 20;
constexpr size_t kMaxZarrAxes = 4;
constexpr size_t kMaxItemBytes = 1 << 20;
constexpr size_t kMaxChunks = 1 << 20;
// Groups within groups, and arrays and attributes of all of them.
constexpr int kMaxDepth = 8;
constexpr size_t kMaxArrays = 4096;
// Bytes of a chunk that is written, before it is packed.
constexpr size_t kChunkBytes = 1 << 20;
constexpr int kZlibLevel = 5;
// Tells inflate to take the headers of zlib and of gzip.
constexpr int kEitherHeader = MAX_WBITS + 32;

absl::Status MakeZarrFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  return error ? IoError(folder, error.message()) : absl::OkStatus();
}

std::string ZarrPath(const std::string& folder, const std::string& name) {
  return fs::path(folder) / name;
}

// The package zarr reads descriptions and attributes as ASCII.
std::string AsciiText(const ZarrJson& json) {
  return json.dump(4, ' ', /*ensure_ascii=*/true);
}

// Numbers of an array, its type as NumPy names it, and the bytes of each.
struct Payload {
  std::string type;
  size_t item = 0;
  const char* bytes = nullptr;
};

Payload PayloadOf(const NpyArray& array) {
  const auto bytes = [](const auto& values) {
    return reinterpret_cast<const char*>(values.data());
  };
  if (!array.u16.empty()) return {"<u2", 2, bytes(array.u16)};
  if (!array.i16.empty()) return {"<i2", 2, bytes(array.i16)};
  if (!array.i64.empty()) return {"<i8", 8, bytes(array.i64)};
  if (!array.f32.empty()) return {"<f4", 4, bytes(array.f32)};
  return {"<f8", 8, bytes(array.f64)};
}

size_t Product(const std::vector<size_t>& sizes, size_t from = 0) {
  size_t product = 1;
  for (size_t i = from; i < sizes.size(); ++i) product *= sizes[i];
  return product;
}

absl::Status WriteZarrArray(const std::string& folder, const NpyArray& array) {
  const Payload payload = PayloadOf(array);
  const size_t row = Product(array.shape, 1) * payload.item;
  const size_t frames = array.shape[0];
  std::vector<size_t> chunks = array.shape;
  chunks[0] = std::clamp<size_t>(kChunkBytes / std::max<size_t>(row, 1), 1,
                                 std::max<size_t>(frames, 1));
  const ZarrJson description = {
      {"chunks", chunks},
      {"compressor", {{"id", "zlib"}, {"level", kZlibLevel}}},
      {"dtype", payload.type},
      {"fill_value", 0},
      {"filters", nullptr},
      {"order", "C"},
      {"shape", array.shape},
      {"zarr_format", 2}};
  TACTUS_RETURN_IF_ERROR(MakeZarrFolder(folder));
  const std::string rest = [&] {
    std::string zeros;
    for (size_t axis = 1; axis < chunks.size(); ++axis) zeros += ".0";
    return zeros;
  }();
  for (size_t first = 0, number = 0; first < frames;
       first += chunks[0], ++number) {
    // The last chunk is as large as the others.
    std::string plain(chunks[0] * row, '\0');
    std::memcpy(plain.data(), payload.bytes + first * row,
                std::min(chunks[0], frames - first) * row);
    uLongf size = compressBound(plain.size());
    std::string packed(size, '\0');
    if (compress2(reinterpret_cast<Bytef*>(packed.data()), &size,
                  reinterpret_cast<const Bytef*>(plain.data()), plain.size(),
                  kZlibLevel) != Z_OK) {
      return IoError(folder, "zlib has no memory");
    }
    packed.resize(size);
    TACTUS_RETURN_IF_ERROR(
        WriteFileBytes(ZarrPath(folder, absl::StrCat(number, rest)), packed));
  }
  return WriteFileBytes(ZarrPath(folder, kArrayFile), AsciiText(description));
}

absl::StatusOr<ZarrJson> ReadJson(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const std::string text,
                          ReadFileBytes(path, kMaxJsonBytes));
  ZarrJson json = ZarrJson::parse(text, nullptr, false);
  if (!json.is_object()) return TrialFileInvalid(path, "is no JSON object");
  return json;
}

// What .zarray says.
struct ArrayPlan {
  std::vector<size_t> shape;
  std::vector<size_t> chunks;
  std::string type;
  size_t item = 0;
  bool packed = false;
  bool zeros = false;
  std::string separator = ".";
};

// Sizes of an array or a chunk, each at least `least`.
bool TakeSizes(const ZarrJson& json, const char* name, size_t least,
               std::vector<size_t>* out) {
  const auto found = json.find(name);
  if (found == json.end() || !found->is_array() ||
      found->size() > kMaxZarrAxes) {
    return false;
  }
  size_t product = 1;
  for (const ZarrJson& size : *found) {
    if (!size.is_number_unsigned()) return false;
    const auto value = size.get<size_t>();
    if (value < least || value > limits::kMaxTrialArrayBytes) return false;
    product *= std::max<size_t>(value, 1);
    if (product > limits::kMaxTrialArrayBytes) return false;
    out->push_back(value);
  }
  return true;
}

absl::StatusOr<ArrayPlan> ReadPlan(const std::string& path) {
  TACTUS_ASSIGN_OR_RETURN(const ZarrJson json, ReadJson(path));
  ArrayPlan plan;
  if (!TakeSizes(json, "shape", 0, &plan.shape) ||
      !TakeSizes(json, "chunks", 1, &plan.chunks) ||
      plan.shape.size() != plan.chunks.size()) {
    return TrialFileInvalid(
        path, absl::StrCat("shape and chunks must be lists of up to ",
                           kMaxZarrAxes, " whole numbers, as long as another"));
  }
  const ZarrJson type = json.value("dtype", ZarrJson());
  if (type.is_string()) plan.type = type.get<std::string>();
  const bool known = plan.type.size() >= 3 &&
                     plan.type.find_first_not_of(
                         "<>|=abcdefghijklmnopqrstuvwxy"
                         "zU0123456789") == std::string::npos &&
                     absl::SimpleAtoi(plan.type.substr(2), &plan.item);
  if (known && plan.type[1] == 'U') plan.item *= sizeof(char32_t);
  if (!known || plan.item == 0 || plan.item > kMaxItemBytes) {
    return TrialFileInvalid(
        path, absl::StrCat("dtype is ", Quoted(type.dump()),
                           "; use numbers or text, such as <f4 or <U8"));
  }
  const ZarrJson compressor = json.value("compressor", ZarrJson());
  const ZarrJson id =
      compressor.is_object() ? compressor.value("id", ZarrJson()) : ZarrJson();
  plan.packed = !compressor.is_null();
  if (plan.packed && id != "zlib" && id != "gzip") {
    return TrialFileInvalid(
        path, absl::StrCat("compressor is ", Quoted(id.dump()),
                           "; save it with compressor=numcodecs.Zlib()"));
  }
  if (json.value("order", ZarrJson("C")) != "C" ||
      !json.value("filters", ZarrJson()).is_null()) {
    return TrialFileInvalid(path, "order must be C, and filters null");
  }
  const ZarrJson separator = json.value("dimension_separator", ZarrJson("."));
  if (separator != "." && separator != "/") {
    return TrialFileInvalid(path, "dimension_separator must be . or /");
  }
  plan.separator = separator.get<std::string>();
  const ZarrJson fill = json.value("fill_value", ZarrJson());
  plan.zeros = fill == 0 || fill == "" || fill == false;
  return plan;
}

// The `size` bytes of one chunk.
absl::StatusOr<std::string> ReadChunk(const std::string& path,
                                      const ArrayPlan& plan, size_t size) {
  std::error_code error;
  if (plan.zeros && !fs::exists(path, error) && !error) {
    return std::string(size, '\0');
  }
  TACTUS_ASSIGN_OR_RETURN(std::string bytes,
                          ReadFileBytes(path, limits::kMaxTrialArrayBytes));
  const absl::Status damaged =
      TrialFileInvalid(path, absl::StrCat("is no chunk of ", size, " bytes"));
  if (!plan.packed) {
    if (bytes.size() != size) return damaged;
    return bytes;
  }
  std::string plain(size, '\0');
  z_stream stream = {};
  if (inflateInit2(&stream, kEitherHeader) != Z_OK) return damaged;
  stream.next_in = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(plain.data());
  stream.avail_out = static_cast<uInt>(plain.size());
  const int result = inflate(&stream, Z_FINISH);
  inflateEnd(&stream);
  if (result != Z_STREAM_END || stream.avail_out != 0 || stream.avail_in != 0) {
    return damaged;
  }
  return plain;
}

// Puts the part of a chunk that lies in the array where it belongs; `at` is the
// chunk's place among chunks.
void PlaceChunk(const ArrayPlan& plan, const std::vector<size_t>& at,
                const std::string& chunk, std::string* out) {
  const size_t axes = plan.shape.size();
  if (axes == 0) {
    *out = chunk;
    return;
  }
  std::vector<size_t> sizes(axes);
  for (size_t a = 0; a < axes; ++a) {
    sizes[a] = std::min(plan.chunks[a], plan.shape[a] - at[a] * plan.chunks[a]);
  }
  const size_t line = sizes[axes - 1] * plan.item;
  const size_t lines = Product(sizes) / sizes[axes - 1];
  for (size_t l = 0; l < lines; ++l) {
    size_t rest = l;
    size_t from = 0;
    size_t to = at[axes - 1] * plan.chunks[axes - 1];
    size_t from_step = plan.chunks[axes - 1];
    size_t to_step = plan.shape[axes - 1];
    for (size_t a = axes - 1; a-- > 0;) {
      const size_t place = rest % sizes[a];
      rest /= sizes[a];
      from += place * from_step;
      to += (at[a] * plan.chunks[a] + place) * to_step;
      from_step *= plan.chunks[a];
      to_step *= plan.shape[a];
    }
    std::memcpy(out->data() + to * plan.item, chunk.data() + from * plan.item,
                line);
  }
}

absl::StatusOr<NpyArray> ReadZarrArray(const std::string& folder,
                                       size_t* bytes_left) {
  const std::string path = ZarrPath(folder, kArrayFile);
  TACTUS_ASSIGN_OR_RETURN(const ArrayPlan plan, ReadPlan(path));
  const size_t axes = plan.shape.size();
  const size_t size = Product(plan.shape) * plan.item;
  const size_t chunk_size = Product(plan.chunks) * plan.item;
  size_t count = 1;
  for (size_t a = 0; a < axes; ++a) {
    count *= (plan.shape[a] + plan.chunks[a] - 1) / plan.chunks[a];
  }
  // A chunk may be far larger than the part of it that lies in the array, and
  // an absent one costs its writer nothing, so whole chunks count.
  if (chunk_size > limits::kMaxTrialArrayBytes || count > kMaxChunks ||
      count * chunk_size > *bytes_left) {
    return TrialFileInvalid(
        path,
        absl::StrCat("has ", size, " bytes in ", count, " chunks of ",
                     chunk_size, "; the chunks of a trial have at most ",
                     limits::kMaxTrialArrayBytes,
                     " bytes, and those of an array are at most ", kMaxChunks));
  }
  *bytes_left -= count * chunk_size;
  std::string values(size, '\0');
  std::vector<size_t> at(axes, 0);
  for (size_t number = 0; number < count; ++number) {
    const std::string key = axes == 0 ? "0" : absl::StrJoin(at, plan.separator);
    TACTUS_ASSIGN_OR_RETURN(const std::string chunk,
                            ReadChunk(ZarrPath(folder, key), plan, chunk_size));
    PlaceChunk(plan, at, chunk, &values);
    for (size_t a = axes; a-- > 0;) {
      if (++at[a] * plan.chunks[a] < plan.shape[a]) break;
      at[a] = 0;
    }
  }
  return ParseNpy(path, NpyHeader(plan.type, plan.shape) + values);
}

absl::Status ReadAttributes(const std::string& path, const std::string& prefix,
                            NpzArrays* arrays) {
  std::error_code error;
  if (!fs::exists(path, error)) return absl::OkStatus();
  TACTUS_ASSIGN_OR_RETURN(const ZarrJson json, ReadJson(path));
  for (const auto& [name, value] : json.items()) {
    NpyArray& array = (*arrays)[prefix + name];
    if (value.is_number()) {
      array.f64 = {value.get<double>()};
    } else if (value.is_string()) {
      array.text = {value.get<std::string>()};
    } else {
      return TrialFileInvalid(path, absl::StrCat("attribute ", Quoted(name),
                                                 " must be a number or text"));
    }
  }
  return absl::OkStatus();
}

absl::Status ReadGroup(const std::string& folder, const std::string& prefix,
                       int depth, size_t* bytes_left, NpzArrays* arrays) {
  TACTUS_RETURN_IF_ERROR(
      ReadAttributes(ZarrPath(folder, kAttributesFile), prefix, arrays));
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::string inside = it->path();
    const std::string name = prefix + it->path().filename().string();
    if (arrays->size() > kMaxArrays || depth > kMaxDepth) {
      return TrialFileInvalid(folder, "has too many arrays or groups");
    }
    if (IsZarrGroup(inside)) {
      TACTUS_RETURN_IF_ERROR(
          ReadGroup(inside, name + "/", depth + 1, bytes_left, arrays));
    } else if (IsZarrArray(inside)) {
      if (arrays->contains(name)) {
        return TrialFileInvalid(inside, "is an attribute of its group too");
      }
      TACTUS_ASSIGN_OR_RETURN((*arrays)[name],
                              ReadZarrArray(inside, bytes_left));
    }
  }
  return error ? IoError(folder, error.message()) : absl::OkStatus();
}

}  // namespace

bool IsZarrGroup(const std::string& folder) {
  std::error_code error;
  return fs::is_regular_file(ZarrPath(folder, kGroupFile), error);
}

bool IsZarrArray(const std::string& folder) {
  std::error_code error;
  return fs::is_regular_file(ZarrPath(folder, kArrayFile), error);
}

absl::Status MakeZarrGroup(const std::string& folder) {
  TACTUS_RETURN_IF_ERROR(MakeZarrFolder(folder));
  if (IsZarrGroup(folder)) return absl::OkStatus();
  return WriteFileBytes(ZarrPath(folder, kGroupFile), kGroupText);
}

absl::Status WriteZarr(
    const std::string& folder,
    const std::vector<std::pair<std::string, std::string>>& arrays) {
  std::error_code error;
  if (fs::exists(folder, error)) {
    return IoError(folder, "exists; Zarr is written to a new folder");
  }
  // By group; "" is `folder` itself.
  std::map<std::string, ZarrJson> attributes;
  attributes[""] = ZarrJson::object();
  for (const auto& [name, bytes] : arrays) {
    TACTUS_ASSIGN_OR_RETURN(const NpyArray array, ParseNpy(name, bytes));
    const size_t slash = name.rfind('/');
    const std::string group = slash == name.npos ? "" : name.substr(0, slash);
    // Each of "a" and "a/b" is a group.
    for (size_t at = 0; at != group.npos && !group.empty();) {
      at = group.find('/', at + 1);
      attributes.try_emplace(group.substr(0, at), ZarrJson::object());
    }
    if (!array.shape.empty()) {
      TACTUS_RETURN_IF_ERROR(WriteZarrArray(ZarrPath(folder, name), array));
      continue;
    }
    ZarrJson& value =
        attributes[group][name.substr(group.empty() ? 0 : slash + 1)];
    if (!array.text.empty()) {
      value = array.text.front();
    } else {
      value = array.f64.front();
    }
  }
  for (auto group = attributes.rbegin(); group != attributes.rend(); ++group) {
    const std::string inside =
        group->first.empty() ? folder : ZarrPath(folder, group->first);
    TACTUS_RETURN_IF_ERROR(MakeZarrFolder(inside));
    if (!group->second.empty()) {
      TACTUS_RETURN_IF_ERROR(WriteFileBytes(ZarrPath(inside, kAttributesFile),
                                            AsciiText(group->second)));
    }
    TACTUS_RETURN_IF_ERROR(MakeZarrGroup(inside));
  }
  return absl::OkStatus();
}

absl::StatusOr<NpzArrays> ReadZarr(const std::string& folder) {
  std::error_code error;
  if (!IsZarrGroup(folder)) {
    return TrialFileInvalid(
        folder, fs::exists(ZarrPath(folder, kVersion3File), error)
                    ? "is Zarr version 3; save it with zarr_format=2"
                    : "is no group of Zarr: it has no .zgroup");
  }
  NpzArrays arrays;
  size_t bytes_left = limits::kMaxTrialArrayBytes;
  TACTUS_RETURN_IF_ERROR(ReadGroup(folder, "", 0, &bytes_left, &arrays));
  return arrays;
}

}  // namespace tactus::internal

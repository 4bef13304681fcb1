#include "core/files/hdf5_filters.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "core/base/text.h"

namespace tactus::internal {
namespace {

constexpr H5Z_filter_t kReadFilters[] = {
    H5Z_FILTER_DEFLATE, H5Z_FILTER_SHUFFLE, H5Z_FILTER_FLETCHER32,
    H5Z_FILTER_SZIP,    H5Z_FILTER_NBIT,    H5Z_FILTER_SCALEOFFSET};

// Filters of other programs, as The HDF Group registers them.
constexpr std::pair<H5Z_filter_t, absl::string_view> kNames[] = {
    {305, "lzo"},      {307, "bzip2"},        {32000, "lzf"},
    {32001, "blosc"},  {32002, "mafisc"},     {32003, "snappy"},
    {32004, "lz4"},    {32008, "bitshuffle"}, {32013, "zfp"},
    {32014, "fpzip"},  {32015, "zstd"},       {32017, "sz"},
    {32026, "blosc2"},
};

std::string FilterName(H5Z_filter_t filter, const char* stored) {
  for (const auto& [number, name] : kNames) {
    if (number == filter) return std::string(name);
  }
  return stored[0] == '\0' ? "without a name" : Printable(stored);
}

}  // namespace

absl::Status CheckFilters(hid_t properties, absl::string_view name,
                          const Hdf5Complaint& complain) {
  const int count = H5Pget_nfilters(properties);
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0;
    size_t values = 0;
    unsigned how = 0;
    char stored[64] = "";
    const H5Z_filter_t filter =
        H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values,
                       nullptr, sizeof(stored), stored, &how);
    if (filter < 0) return complain.Hdf5(name);
    stored[sizeof(stored) - 1] = '\0';
    const bool read =
        std::find(std::begin(kReadFilters), std::end(kReadFilters), filter) !=
            std::end(kReadFilters) &&
        H5Zfilter_avail(filter) > 0;
    if (read) continue;
    return complain(
        name, "went through the filter ", FilterName(filter, stored), " (",
        filter,
        "); those that are read are gzip, szip, shuffle and Fletcher-32. Write "
        "it again with gzip, e.g. with h5py: "
        "out.create_dataset(name, data=file[name][:], compression=\"gzip\")");
  }
  return absl::OkStatus();
}

}  // namespace tactus::internal

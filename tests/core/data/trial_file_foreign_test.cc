// Trial files that other programs write, and other programs that read ours.
#include <hdf5.h>

#include <cstdlib>

#include "core/base/errors.h"
#include "core/data/trial_file.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "tests/core/data/trial_samples.h"

namespace tactus::internal {
namespace {

using testing::HasSubstr;

constexpr hsize_t kFrames = 4;

// Writes files with the plain HDF5 library, old layout and text of variable
// length, as h5py does.
class ForeignFile {
 public:
  explicit ForeignFile(const std::string& path)
      : file_(
            H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT)) {
    Text(file_, "format", "tactus-trials");
    Int(file_, "version", 1);
    trials_ =
        H5Gcreate2(file_, "trials", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
    group_ =
        H5Gcreate2(trials_, "000007", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  }
  ~ForeignFile() {
    H5Gclose(group_);
    H5Gclose(trials_);
    H5Fclose(file_);
  }
  ForeignFile(const ForeignFile&) = delete;
  ForeignFile& operator=(const ForeignFile&) = delete;

  hid_t file() const { return file_; }
  hid_t group() const { return group_; }

  void Text(hid_t object, const char* name, const char* value) {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    Attribute(object, name, type, type, &value);
    H5Tclose(type);
  }
  void Int(hid_t object, const char* name, int value) {
    Attribute(object, name, H5T_STD_I64LE, H5T_NATIVE_INT, &value);
  }
  void Float(hid_t object, const char* name, float value) {
    Attribute(object, name, H5T_IEEE_F32BE, H5T_NATIVE_FLOAT, &value);
  }

  // Fills a dataset with `value`, or 0.01 x index if it is negative.
  void Array(const char* name, hid_t type, const std::vector<hsize_t>& dims,
             double value) {
    size_t count = 1;
    for (const hsize_t size : dims) count *= size;
    std::vector<double> values(count, value);
    for (size_t i = 0; value < 0 && i < count; ++i) values[i] = 0.01 * i;
    const hid_t space =
        H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
    const hid_t dataset = H5Dcreate2(group_, name, type, space, H5P_DEFAULT,
                                     H5P_DEFAULT, H5P_DEFAULT);
    H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT,
             values.data());
    H5Dclose(dataset);
    H5Sclose(space);
  }

 private:
  static void Attribute(hid_t object, const char* name, hid_t file_type,
                        hid_t memory_type, const void* value) {
    const hid_t space = H5Screate(H5S_SCALAR);
    DeleteIfThere(object, name);
    const hid_t attribute =
        H5Acreate2(object, name, file_type, space, H5P_DEFAULT, H5P_DEFAULT);
    H5Awrite(attribute, memory_type, value);
    H5Aclose(attribute);
    H5Sclose(space);
  }
  static void DeleteIfThere(hid_t object, const char* name) {
    if (H5Aexists(object, name) > 0) H5Adelete(object, name);
  }

  hid_t file_;
  hid_t trials_;
  hid_t group_;
};

void WriteMinimal(ForeignFile& file) {
  file.Array("time", H5T_IEEE_F64LE, {kFrames}, -1);
  file.Array("signals", H5T_IEEE_F64LE, {kFrames, 3}, 0.25);
}

TEST(ForeignTrialFileTest, MissingAttributesGetDefaults) {
  const ScratchDir dir;
  {
    ForeignFile file(dir / "a.h5");
    WriteMinimal(file);
  }
  auto reader = TrialFileReader::Open(dir / "a.h5");
  ASSERT_TRUE(reader.ok()) << reader.status();
  auto trial = reader->Read(0);
  ASSERT_TRUE(trial.ok()) << trial.status();
  const Trial fresh;
  EXPECT_EQ(trial->id, "000007");
  EXPECT_EQ(trial->label, fresh.label);
  EXPECT_EQ(trial->unit, fresh.unit);
  EXPECT_EQ(trial->sample_rate_hz, fresh.sample_rate_hz);
  EXPECT_EQ(trial->signals[3][2], 0.25);
}

TEST(ForeignTrialFileTest, OtherTypesAndExtrasAreRead) {
  const ScratchDir dir;
  {
    ForeignFile file(dir / "a.h5");
    // MATLAB has no vectors; other machines have other byte orders.
    file.Array("time", H5T_IEEE_F32BE, {kFrames, 1}, -1);
    file.Array("taxels", H5T_STD_U16BE, {kFrames, 2, 3}, 300);
    file.Array("temperature", H5T_STD_I8LE, {2}, 30);
    file.Text(file.group(), "label", "HU");
    file.Text(file.group(), "operator", "somebody");
    file.Int(file.group(), "stiffness", 500);
    file.Float(file.group(), "sample_rate_hz", 50);
  }
  auto reader = TrialFileReader::Open(dir / "a.h5");
  ASSERT_TRUE(reader.ok()) << reader.status();
  auto trial = reader->Read(0);
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->time.size(), kFrames);
  EXPECT_EQ(trial->taxels.u16, std::vector<uint16_t>(24, 300));
  EXPECT_EQ(trial->taxels.scale, 1);
  EXPECT_EQ(trial->taxels.rows, 2);
  EXPECT_EQ(trial->label, "HU");
  EXPECT_EQ(trial->stiffness, 500);
  EXPECT_EQ(trial->sample_rate_hz, 50);
}

struct BadFile {
  const char* text;
  void (*write)(ForeignFile&);
};

class BadForeignTrialFileTest : public testing::TestWithParam<BadFile> {};

TEST_P(BadForeignTrialFileTest, IsRefusedByName) {
  const ScratchDir dir;
  {
    ForeignFile file(dir / "a.h5");
    GetParam().write(file);
  }
  auto reader = TrialFileReader::Open(dir / "a.h5");
  const absl::Status status =
      reader.ok() ? reader->Read(0).status() : reader.status();
  EXPECT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID");
  EXPECT_THAT(std::string(status.message()), HasSubstr("a.h5: "));
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().text));
}

INSTANTIATE_TEST_SUITE_P(
    All, BadForeignTrialFileTest,
    testing::Values(
        BadFile{
            "format: is \"something\"",
            [](ForeignFile& f) { f.Text(f.file(), "format", "something"); }},
        BadFile{"format: must be text",
                [](ForeignFile& f) { f.Int(f.file(), "format", 3); }},
        BadFile{"version: is 2",
                [](ForeignFile& f) { f.Int(f.file(), "version", 2); }},
        BadFile{"version: must be a number",
                [](ForeignFile& f) { f.Text(f.file(), "version", "1"); }},
        BadFile{
            "trials: is missing",
            [](ForeignFile& f) { H5Ldelete(f.file(), "trials", H5P_DEFAULT); }},
        BadFile{"trials: is a link to another place",
                [](ForeignFile& f) {
                  H5Ldelete(f.file(), "trials", H5P_DEFAULT);
                  H5Lcreate_external("other.h5", "/trials", f.file(), "trials",
                                     H5P_DEFAULT, H5P_DEFAULT);
                }},
        BadFile{"trial 000007: time: is missing", [](ForeignFile&) {}},
        BadFile{"trial 000007: time: must be floating-point",
                [](ForeignFile& f) {
                  f.Array("time", H5T_STD_I32LE, {kFrames}, -1);
                }},
        BadFile{"trial 000007: time: has shape 4 x 2; it must be T",
                [](ForeignFile& f) {
                  f.Array("time", H5T_IEEE_F64LE, {kFrames, 2}, -1);
                }},
        BadFile{"trial 000007: time: entry 1 is",
                [](ForeignFile& f) {
                  f.Array("time", H5T_IEEE_F64LE, {kFrames}, 5);
                }},
        BadFile{"trial 000007: signals: missing",
                [](ForeignFile& f) {
                  f.Array("time", H5T_IEEE_F64LE, {kFrames}, -1);
                }},
        BadFile{"trial 000007: signals: has shape 5 x 3; it must be 4 x 3",
                [](ForeignFile& f) {
                  f.Array("time", H5T_IEEE_F64LE, {kFrames}, -1);
                  f.Array("signals", H5T_IEEE_F64LE, {5, 3}, 0);
                }},
        BadFile{"trial 000007: taxels: must be uint16, int16 or float32",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Array("taxels", H5T_STD_I32LE, {kFrames, 2, 2}, 0);
                }},
        BadFile{"trial 000007: taxels: are int16; only a skin with signed",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Array("taxels", H5T_STD_I16LE, {kFrames, 2, 2}, 0);
                }},
        BadFile{"trial 000007: taxels: has shape 4 x 2 x 2 x 2; it must be "
                "4 x rows x columns x 3",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Array("taxels", H5T_STD_U16LE, {kFrames, 2, 2, 2}, 0);
                }},
        BadFile{"trial 000007: taxels: has shape 4 x 4; it must be 4 x rows x "
                "columns",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Array("taxels", H5T_STD_U16LE, {kFrames, 4}, 0);
                }},
        BadFile{"trial 000007: taxels: frames are 65 x 2",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Array("taxels", H5T_STD_U16LE, {kFrames, 65, 2}, 0);
                }},
        BadFile{"trial 000007: pose: has shape 4 x 6; it must be 4 x 7",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Array("pose", H5T_IEEE_F64LE, {kFrames, 6}, 0);
                }},
        BadFile{"trial 000007: pose: quaternion of row 0",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Array("pose", H5T_IEEE_F64LE, {kFrames, 7}, 0);
                }},
        BadFile{"trial 000007: label: must be text",
                [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Int(f.group(), "label", 3);
                }},
        BadFile{"trial 000007: unit: is \"psi\"", [](ForeignFile& f) {
                  WriteMinimal(f);
                  f.Text(f.group(), "unit", "psi");
                }}));

// Claims 10^7 frames of 64 x 64 that were never written.
TEST(ForeignTrialFileTest, AHugeShapeIsRefusedBeforeItIsAllocated) {
  const ScratchDir dir;
  {
    ForeignFile file(dir / "a.h5");
    const hsize_t dims[] = {10'000'000};
    const hid_t space = H5Screate_simple(1, dims, nullptr);
    H5Dclose(H5Dcreate2(file.group(), "time", H5T_IEEE_F64LE, space,
                        H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
    H5Sclose(space);
  }
  auto reader = TrialFileReader::Open(dir / "a.h5");
  EXPECT_THAT(std::string(reader.status().message()),
              HasSubstr("a.h5: trial 000007: time: its data is missing"));
}

// Without checksums a flipped bit may change a value unnoticed, or crash the
// HDF5 library. It must not crash this process.
TEST(ForeignTrialFileTest, NoFlippedBitCrashes) {
  const ScratchDir dir;
  {
    ForeignFile file(dir / "good.h5");
    WriteMinimal(file);
    file.Text(file.group(), "label", "HU");
  }
  const std::string bytes = ReadBytes(dir / "good.h5");
  Random random(5);
  int errors = 0;
  for (int i = 0; i < 500; ++i) {
    std::string damaged = bytes;
    const size_t at = random.Index(damaged.size());
    damaged[at] ^= static_cast<char>(1 << random.Index(8));
    WriteBytes(dir / "bad.h5", damaged);
    auto reader = TrialFileReader::Open(dir / "bad.h5");
    const absl::Status status =
        reader.ok() ? reader->ReadAll().status() : reader.status();
    if (status.ok()) continue;
    ++errors;
    ASSERT_EQ(ReasonOf(status), "TRIAL_FILE_INVALID") << status;
  }
  EXPECT_GT(errors, 20);
}

// Debian's Python with h5py is an independent reader. Where it is absent, the
// test prints that and passes.
TEST(ForeignTrialFileTest, H5pyReadsWhatWeWrite) {
  if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) {
    std::puts("h5py is absent (python3-h5py): not compared");
    return;
  }
  const ScratchDir dir;
  auto writer = TrialFileWriter::Create(dir / "a.h5", {});
  ASSERT_TRUE(writer.ok());
  Trial trial = FullTrial(9, 40);
  trial.object.clear();
  trial.taxels.u16[5] = 4711;
  ASSERT_TRUE(writer->Append(trial).ok());
  ASSERT_TRUE(writer->Append(TrialOfTouches(8, 40)).ok());
  ASSERT_TRUE(writer->Close().ok());
  WriteBytes(dir / "check.py", R"(
import sys, h5py
f = h5py.File(sys.argv[1], 'r')
def text(v): return v.decode() if isinstance(v, bytes) else v
assert text(f.attrs['format']) == 'tactus-trials'
assert f.attrs['version'] == 1
g = f['trials/000000']
assert g['time'].shape == (40,) and g['time'].dtype == 'f8'
assert g['signals'].shape == (40, 3) and g['signals'].dtype == 'f8'
assert g['taxels'].shape == (40, 3, 4) and g['taxels'].dtype == 'u2'
assert g['taxels'][0, 1, 1] == 4711 and g['taxels'].attrs['scale'] == 0.5
assert g['pose'].shape == (40, 7)
assert abs((g['pose'][:, 3:] ** 2).sum(axis=1) - 1).max() < 1e-12
assert text(g.attrs['label']) == 'SM' and text(g.attrs['object']) == ''
assert text(g.attrs['material']) == 'polymer foam'
assert g.attrs['stiffness'] == 1234.5678901234567
g = f['trials/000001']
assert list(g['touches']) == ['00', '01']
t = g['touches/00']
assert t.attrs['begin_s'] == g['time'][1] and t.attrs['end_s'] == g['time'][39]
assert t.attrs['row'] == 1 / 3 and t.attrs['column'] == 2.7
assert t['object_motion'].shape == (39,)
assert text(g['touches/01'].attrs['label']) == 'egg'
assert 'row' not in g['touches/01'].attrs
)");
  const std::string command =
      "/usr/bin/python3 " + (dir / "check.py") + " " + (dir / "a.h5");
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST(ForeignTrialFileTest, WeReadWhatH5pyWrites) {
  if (std::system("/usr/bin/python3 -c 'import h5py' 2>/dev/null") != 0) {
    std::puts("h5py is absent (python3-h5py): not compared");
    return;
  }
  const ScratchDir dir;
  // The example of docs/formats.md.
  WriteBytes(dir / "write.py", R"(
import sys, h5py, numpy as np
with h5py.File(sys.argv[1], 'w') as f:
    f.attrs['format'] = 'tactus-trials'
    f.attrs['version'] = 1
    g = f.create_group('trials/000000')
    g['time'] = np.arange(500) / 100.0
    d = g.create_dataset('taxels', data=np.full((500, 16, 24), 20, 'u2'),
                         compression='gzip', shuffle=True)
    d.attrs['scale'] = 0.001
    g.attrs['label'] = 'HU'
    g.attrs['object'] = 'gr\u00fcn'
    for i, (begin, end, label) in enumerate([(1, 1.99, 'HU'), (2.5, 4, 'SM')]):
        t = g.create_group(f'touches/{i:02d}')
        t.attrs['begin_s'] = begin
        t.attrs['end_s'] = end
        t.attrs['label'] = label
)");
  const std::string command =
      "/usr/bin/python3 " + (dir / "write.py") + " " + (dir / "a.h5");
  ASSERT_EQ(std::system(command.c_str()), 0);
  auto reader = TrialFileReader::Open(dir / "a.h5");
  ASSERT_TRUE(reader.ok()) << reader.status();
  auto trial = reader->Read(0);
  ASSERT_TRUE(trial.ok()) << trial.status();
  EXPECT_EQ(trial->label, "HU");
  EXPECT_EQ(trial->object, "gr\xC3\xBCn");
  ASSERT_EQ(trial->touches.size(), 2);
  EXPECT_EQ(trial->touches[1].label, "SM");
  EXPECT_EQ(trial->touches[1].begin_s, 2.5);
  EXPECT_EQ(trial->touches[0].end_s, 1.99);
  EXPECT_FALSE(trial->touches[0].centre);
  EXPECT_EQ(trial->taxels.scale, 0.001);
  EXPECT_EQ(trial->taxels.u16, std::vector<uint16_t>(500 * 16 * 24, 20));
}

}  // namespace
}  // namespace tactus::internal

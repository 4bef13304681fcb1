#include "tests/support/crash_vfs.h"

#include <atomic>
#include <filesystem>
#include <new>

namespace tactus::internal::testing {
namespace {

sqlite3_vfs* Real() { return sqlite3_vfs_find("unix"); }

CrashFileSystem& FilesOf(sqlite3_vfs* vfs) {
  return *static_cast<CrashFileSystem*>(vfs->pAppData);
}

int CodeOf(const absl::Status& status, int otherwise) {
  if (status.ok()) return SQLITE_OK;
  return status.code() == absl::StatusCode::kResourceExhausted ? SQLITE_FULL
                                                               : otherwise;
}

// The real file lies behind it.
struct File {
  sqlite3_file base;
  CrashFileSystem* files;
  std::string* path;
  bool counted;

  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};

File* Of(sqlite3_file* file) { return reinterpret_cast<File*>(file); }
const sqlite3_io_methods& Methods(sqlite3_file* file) {
  return *Of(file)->real()->pMethods;
}

int Close(sqlite3_file* file) {
  delete Of(file)->path;
  return Methods(file).xClose(Of(file)->real());
}
int Read(sqlite3_file* file, void* to, int size, sqlite3_int64 offset) {
  return Methods(file).xRead(Of(file)->real(), to, size, offset);
}
int Write(sqlite3_file* file, const void* from, int size,
          sqlite3_int64 offset) {
  if (Of(file)->counted) {
    const absl::Status status =
        Of(file)->files->BeforeWrite(*Of(file)->path, offset, size);
    if (!status.ok()) {
      Methods(file).xWrite(Of(file)->real(), from, size / 2, offset);
      return CodeOf(status, SQLITE_IOERR_WRITE);
    }
  }
  return Methods(file).xWrite(Of(file)->real(), from, size, offset);
}
int Truncate(sqlite3_file* file, sqlite3_int64 size) {
  if (Of(file)->counted) {
    const absl::Status status =
        Of(file)->files->BeforeTruncate(*Of(file)->path, size);
    if (!status.ok()) return CodeOf(status, SQLITE_IOERR_TRUNCATE);
  }
  return Methods(file).xTruncate(Of(file)->real(), size);
}
int Sync(sqlite3_file* file, int) {
  if (!Of(file)->counted) return SQLITE_OK;
  return CodeOf(Of(file)->files->BeforeSync(*Of(file)->path),
                SQLITE_IOERR_FSYNC);
}
int FileSize(sqlite3_file* file, sqlite3_int64* size) {
  return Methods(file).xFileSize(Of(file)->real(), size);
}
int Lock(sqlite3_file* file, int level) {
  return Methods(file).xLock(Of(file)->real(), level);
}
int Unlock(sqlite3_file* file, int level) {
  return Methods(file).xUnlock(Of(file)->real(), level);
}
int CheckReserved(sqlite3_file* file, int* answer) {
  return Methods(file).xCheckReservedLock(Of(file)->real(), answer);
}
int Control(sqlite3_file* file, int what, void* argument) {
  return Methods(file).xFileControl(Of(file)->real(), what, argument);
}
int SectorSize(sqlite3_file* file) {
  return Methods(file).xSectorSize(Of(file)->real());
}
int Characteristics(sqlite3_file* file) {
  return Methods(file).xDeviceCharacteristics(Of(file)->real());
}
int ShmMap(sqlite3_file* file, int page, int size, int extend,
           void volatile** memory) {
  return Methods(file).xShmMap(Of(file)->real(), page, size, extend, memory);
}
int ShmLock(sqlite3_file* file, int offset, int count, int flags) {
  return Methods(file).xShmLock(Of(file)->real(), offset, count, flags);
}
void ShmBarrier(sqlite3_file* file) {
  Methods(file).xShmBarrier(Of(file)->real());
}
int ShmUnmap(sqlite3_file* file, int remove) {
  return Methods(file).xShmUnmap(Of(file)->real(), remove);
}

constexpr sqlite3_io_methods kMethods = {2,
                                         Close,
                                         Read,
                                         Write,
                                         Truncate,
                                         Sync,
                                         FileSize,
                                         Lock,
                                         Unlock,
                                         CheckReserved,
                                         Control,
                                         SectorSize,
                                         Characteristics,
                                         ShmMap,
                                         ShmLock,
                                         ShmBarrier,
                                         ShmUnmap,
                                         nullptr,
                                         nullptr};

int Open(sqlite3_vfs* vfs, const char* name, sqlite3_file* out, int flags,
         int* out_flags) {
  File* file = new (out) File();
  const bool is_new = name != nullptr && !std::filesystem::exists(name);
  const int code = Real()->xOpen(Real(), name, file->real(), flags, out_flags);
  if (code != SQLITE_OK) {
    file->base.pMethods = nullptr;
    return code;
  }
  file->base.pMethods = &kMethods;
  file->files = &FilesOf(vfs);
  file->counted = name != nullptr;
  file->path = new std::string(name == nullptr ? "" : name);
  if (is_new) file->files->OnCreate(name);
  return SQLITE_OK;
}

int Delete(sqlite3_vfs* vfs, const char* name, int sync_directory) {
  const absl::Status status = FilesOf(vfs).BeforeRemove(name);
  if (!status.ok()) return CodeOf(status, SQLITE_IOERR_DELETE);
  return Real()->xDelete(Real(), name, sync_directory);
}

std::string NewName() {
  static std::atomic<int> number = 0;
  return "crash-" + std::to_string(++number);
}

}  // namespace

CrashVfs::CrashVfs(CrashFileSystem* files) : name_(NewName()), vfs_(*Real()) {
  vfs_.szOsFile = static_cast<int>(sizeof(File)) + Real()->szOsFile;
  vfs_.zName = name_.c_str();
  vfs_.pAppData = files;
  vfs_.pNext = nullptr;
  vfs_.xOpen = Open;
  vfs_.xDelete = Delete;
  sqlite3_vfs_register(&vfs_, 0);
}

CrashVfs::~CrashVfs() { sqlite3_vfs_unregister(&vfs_); }

}  // namespace tactus::internal::testing

// File: job_files.h
//
// Files in a job's folder that the server writes for tactus-trainer (job.h says
// what is in them).
//
//   ReadWhole(files, folder + kCandidateFile, limits::kMaxBundleBytes);
//
// Constants without state.
#pragma once

namespace tactus::internal::server {

// Built-in bundles, which are no blobs.
inline constexpr char kCandidateFile[] = "/candidate.tactus";
inline constexpr char kCurrentFile[] = "/current.tactus";

}  // namespace tactus::internal::server

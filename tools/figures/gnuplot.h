// File: gnuplot.h
//
// Runs gnuplot on a script and returns the picture that it draws.
//
//   GnuplotScript script(1120, 800);
//   script.Add("plot sin(x)");
//   TACTUS_ASSIGN_OR_RETURN(std::string png, RunGnuplot(script.text()));
//
// gnuplot is a separate program (Debian package gnuplot-nox), looked up in
// PATH. It reads the script from its standard input and writes the picture to
// its standard output, so no temporary files are involved. User settings
// (~/.gnuplot) are ignored: the same script draws the same picture.
//
// Free functions without state; thread-safe.
#pragma once

#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace tactus::internal::client {

// What the script writes to standard output: for a GnuplotScript, the bytes of
// a PNG file. IO if gnuplot is not installed (the text names the package), or
// if it rejects the script (the text holds gnuplot's first complaint).
absl::StatusOr<std::string> RunGnuplot(const std::string& script);

// Runs the script and writes the picture to `path`. Errors are those of
// RunGnuplot, and IO if `path` cannot be written.
absl::Status DrawToFile(const std::string& script, const std::string& path);

}  // namespace tactus::internal::client

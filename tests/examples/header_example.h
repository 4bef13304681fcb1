// File: header_example.h
//
// The example in the comment that a header begins with. Test-only.
//
//   const std::string code =
//       HeaderExample("// File: a.h\n//\n//   A a;\n//\n");  // "   A a;\n"
#pragma once

#include <string>

namespace tactus::internal {

// The blocks of code as they stand there, an empty line between two; empty if
// there are none. A block follows an empty comment line, is indented by three
// blanks or more, and holds a semicolon.
std::string HeaderExample(const std::string& header);

}  // namespace tactus::internal

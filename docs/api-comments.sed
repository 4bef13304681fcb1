# Comments as doxygen reads them, for docs/make-api.sh.
# Links of a page to files that are no pages there.
s|\[([^]]*)\]\(\.\./[^)]*\)|\1|g
s|^// File: (.*)$|/// \\file \1|
t
/^ *\/\//{
  # A command would begin with it.
  s|@|\\@|g
  # Code, and tables, stay as they are.
  s|^( *)//   (.*)$|\1///     \2|
  t
  s|^( *)//|\1///|
}

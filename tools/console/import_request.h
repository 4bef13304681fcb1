// File: import_request.h
//
// ServeImport: one request of an import (import_target.h) on a connection of a
// browser, which ends with it. Bodies of files go to the disk part by part.
//
//   ServeImport(std::move(stream), std::move(buffer),
//               {parser.release(), parser.content_length()}, &browsers);
//
// `buffer` has what came behind the header. A browser that goes, or sends too
// slowly, ends its import. Kept alive by what it waits for; for the thread that
// serves browsers. `browsers` must outlive it.
#pragma once

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/optional.hpp>
#include <cstdint>

#include "tools/console/browsers.h"
#include "tools/console/responses.h"
#include "tools/console/watch_socket.h"

namespace tactus::internal::console {

struct ImportHead {
  // Without a body.
  Request request;
  boost::optional<uint64_t> body_bytes;
};

template <class Stream>
void ServeImport(Stream stream, boost::beast::flat_buffer buffer,
                 ImportHead head, Browsers* browsers);

extern template void ServeImport(PlainStream, boost::beast::flat_buffer,
                                 ImportHead, Browsers*);
extern template void ServeImport(TlsStream, boost::beast::flat_buffer,
                                 ImportHead, Browsers*);

}  // namespace tactus::internal::console

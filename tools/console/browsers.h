// File: browsers.h
//
// What all connections of browsers share. Used on the thread that serves them,
// but for `waker` and `calls`.
#pragma once

#include <boost/asio/thread_pool.hpp>
#include <memory>
#include <string>

#include "tools/console/doorkeeper.h"
#include "tools/console/imports.h"
#include "tools/console/page_calls.h"
#include "tools/console/page_files.h"
#include "tools/console/sign_ins.h"
#include "tools/console/waker.h"

namespace tactus::internal::console {

struct Browsers {
  PageFiles files;
  Doorkeeper doorkeeper;
  std::shared_ptr<Waker> waker;
  // Calls to servers block; they run here.
  boost::asio::thread_pool* calls = nullptr;
  PageCalls* page_calls = nullptr;
  Imports* imports = nullptr;
  // Browsers of this machine alone can reach the console.
  bool is_loopback = true;
  bool uses_tls = false;
  // Differs from that of any other console, and of this one after a restart.
  std::string session = NewSecret();
  // How many there are now.
  int connections = 0;
  int live_pages = 0;
  int token_checks = 0;
};

}  // namespace tactus::internal::console

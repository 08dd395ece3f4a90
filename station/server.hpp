// SPDX-License-Identifier: Apache-2.0
// Lets pages of a browser on this machine take part in a session: HTTP for the page, a WebSocket for each
// (doc/live_protocol.md). There is no file server: what it sends is compiled in, and no path comes from a
// page.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace aussois {

class LiveSession;

struct ServerOptions {
  std::string address =
      "127.0.0.1";  // anybody who can reach another one can read what is sent: there is no TLS
  int port = 0;     // 0: one that is free
};

class Server {
 public:
  /// The session must outlive it. Throws std::runtime_error if the address cannot be listened at, or if there
  /// are no random numbers for a token.
  Server(LiveSession& session, const ServerOptions& options = {});
  ~Server();

  /// With the token behind #, which a browser never sends.
  std::string address() const;
  int port() const;
  /// Until a page says stop, the session has failed, or `go_on()`, asked at least each 0.1 s, returns false.
  void run(const std::function<bool()>& go_on);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace aussois

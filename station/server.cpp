// SPDX-License-Identifier: Apache-2.0
#include "station/server.hpp"

#include <chrono>
#include <cstdio>
#include <deque>
#include <map>
#include <random>
#include <utility>  // before Asio 1.74, which needs it in C++20

#include <boost/asio.hpp>
#include <boost/beast.hpp>
#include <nlohmann/json.hpp>

#include "geometry/check.hpp"
#include "station/live_page.hpp"
#include "station/live_session.hpp"

namespace aussois {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr std::size_t kPages = 8, kSockets = 32;
constexpr std::size_t kLongest = std::size_t{16} << 10;                       // message of a page [bytes]
constexpr std::size_t kWaiting = 1024, kWaitingBytes = std::size_t{8} << 20;  // messages to a page
constexpr std::uint64_t kUndrawn = 2;                                         // frames on their way
constexpr int kMessagesASecond = 500, kWrongTokens = 3;
constexpr auto kFrame = std::chrono::microseconds(16667);
constexpr auto kDoorShut = seconds(10), kAsked = seconds(5);

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string random_token() {
  std::random_device device;  // throws std::runtime_error if there is none
  std::string out;
  char text[9];
  for (int i = 0; i < 4; ++i) std::snprintf(text, sizeof text, "%08x", device()), out += text;
  return out;
}

// As long for any two texts of a length.
bool same_secret(const std::string& a, const std::string& b) {
  unsigned differ = a.size() != b.size();
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i) differ |= unsigned(a[i] ^ b[i]);
  return differ == 0;
}

class Page;

// What all pages share; used by one thread.
struct Pages {
  LiveSession& session;
  std::string token = random_token(), id = random_token(), host{}, origin{};
  std::map<std::uint64_t, Page*> pages{};
  std::uint64_t next = 1, controller = 0, asking = 0;
  Clock::time_point asked{}, shut_until{};
  int wrong = 0;
  std::size_t sockets = 0;  // of pages, greeted or not
  bool stop = false;

  void send_all(const std::string& text);
  void give_control(std::uint64_t page);
  void tell_roles();
};

// One page of a browser.
class Page : public std::enable_shared_from_this<Page> {
 public:
  Page(tcp::socket socket, Pages& all) : ws_(std::move(socket)), greeting_(ws_.get_executor()), all_(all) {
    ++all_.sockets;
  }
  ~Page() {
    try {
      leave();
    } catch (const std::exception&) {  // no memory to tell the others
    }
    --all_.sockets;
  }

  void accept(const http::request<http::string_body>& request) {
    ws_.set_option(websocket::stream_base::timeout{seconds(5), seconds(20), true});
    ws_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
      response.set(http::field::sec_websocket_protocol, kLiveProtocol);
    }));
    ws_.read_message_max(kLongest);
    ws_.next_layer().expires_never();
    beast::error_code ignored;
    ws_.next_layer().socket().set_option(tcp::no_delay(true), ignored);
    greeting_.expires_after(seconds(5));
    greeting_.async_wait([weak = weak_from_this()](beast::error_code error) {
      if (const auto self = weak.lock(); self && !error && self->id_ == 0)
        self->refuse("no hello within five seconds");
    });
    ws_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
      if (!error) self->read();
    });
  }

  void send(std::string bytes, bool text) {
    if (gone_) return;
    waiting_ += bytes.size();
    out_.push_back({std::move(bytes), text});
    if (out_.size() > kWaiting || waiting_ > kWaitingBytes + meshes_) return refuse("the page is too slow");
    if (out_.size() == 1) write();
  }
  void send(const Json& json) { send(dump(json), true); }

  // The newest frame, unless two are on their way.
  void show(const LiveFrame& frame, const Vec3& origin) {
    if (id_ == 0 || frame.serial == shown_) return;
    if (sent_ - drawn_ >= kUndrawn) {
      if (missed_ != frame.serial) ++skipped_, missed_ = frame.serial;
      return;
    }
    shown_ = frame.serial;
    send(to_bytes(frame, origin, ++sent_, skipped_), false);
  }

  void refuse(const std::string& why) {
    if (gone_) return;
    leave();
    closing_ = websocket::close_reason(websocket::close_code::policy_error, why.substr(0, 120));
    if (out_.empty()) close();
  }

 private:
  struct Message {
    std::string bytes{};
    bool text = false;
  };

  void read() {
    buffer_.clear();
    ws_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
      if (error || self->gone_) return self->leave();
      try {
        self->take(beast::buffers_to_string(self->buffer_.data()), self->ws_.got_text());
      } catch (const std::exception& wrong) {
        return self->refuse(wrong.what());
      }
      if (!self->gone_) self->read();
    });
  }

  void take(const std::string& bytes, bool text) {
    count();
    if (id_ == 0) return hello(bytes, text);
    if (!text) return command(live_command(bytes, all_.session.origin()));
    const Json json = Json::parse(bytes, nullptr, false);
    require(json.is_object() && json.contains("kind") && json["kind"].is_string(),
            "a text must be a JSON object with a kind");
    const auto kind = json["kind"].get<std::string>();
    if (kind == "take_control") return ask_for_control();
    if (kind == "keep_control") return keep_control();
    if (kind == "release") return release();
    if (all_.controller != id_)
      return send({{"kind", "refused"}, {"what", kind}, {"why", "this page only watches"}});
    if (kind == "stop") {
      all_.stop = true;
      return;
    }
    try {
      all_.session.ask(id_, bytes);
    } catch (const std::invalid_argument& wrong) {
      send({{"kind", "refused"}, {"what", kind}, {"why", wrong.what()}});
    }
  }

  void count() {
    const Clock::time_point now = Clock::now();
    if (now - second_ > seconds(1)) second_ = now, messages_ = 0;
    require(++messages_ <= kMessagesASecond, "more than 500 messages a second");
  }

  void hello(const std::string& bytes, bool text) {
    require(text, "the first message must be a hello");
    const Json json = Json::parse(bytes, nullptr, false);
    const auto word = [&](const char* name) {
      const auto at = json.is_object() ? json.find(name) : json.end();
      return at != json.end() && at->is_string() ? at->get<std::string>() : std::string();
    };
    require(word("kind") == "hello" && !word("token").empty(),
            "the first message must be a hello with a token");
    if (!same_secret(word("token"), all_.token)) {
      require(Clock::now() >= all_.shut_until, "three wrong tokens: wait ten seconds");
      if (++all_.wrong >= kWrongTokens) all_.wrong = 0, all_.shut_until = Clock::now() + kDoorShut;
      throw std::invalid_argument("wrong token");
    }
    require(all_.pages.size() < kPages, "eight pages are enough");
    all_.wrong = 0;
    id_ = all_.next++;
    all_.pages[id_] = this;
    if (all_.controller == 0 && word("role") != "viewer") all_.controller = id_;
    Json welcome = Json::parse(all_.session.facts());
    welcome["kind"] = "welcome", welcome["protocol"] = kLiveProtocol, welcome["session"] = all_.id;
    welcome["page"] = id_;
    send(welcome);
    for (const LiveMesh& mesh : all_.session.meshes()) {
      const std::string hash = std::to_string(mesh.hash);
      const bool there = json.contains("have") && json["have"].is_array() &&
                         std::ranges::find(json["have"], Json(hash)) != json["have"].end();
      if (there) continue;
      std::string all = to_bytes(mesh);
      meshes_ += all.size();  // these may be long
      send(std::move(all), false);
    }
    all_.tell_roles();
    all_.session.begin();
  }

  void command(const LiveCommand& said) {
    drawn_ = std::max(drawn_, std::min(said.drawn, sent_));
    if (all_.controller == id_) all_.session.hand(said);  // a viewer moves nothing
  }

  void ask_for_control() {
    if (all_.controller == id_) return;
    if (all_.controller == 0) return all_.give_control(id_);
    all_.asking = id_;
    all_.asked = Clock::now();
    all_.pages.at(all_.controller)->send({{"kind", "control_asked"}, {"seconds", kAsked.count()}});
  }
  void keep_control() {
    if (all_.controller != id_ || all_.asking == 0) return;
    if (const auto who = all_.pages.find(all_.asking); who != all_.pages.end())
      who->second->send({{"kind", "refused"}, {"what", "take_control"}, {"why", "the other page keeps it"}});
    all_.asking = 0;
  }
  void release() {
    if (all_.controller == id_) all_.give_control(all_.asking);
  }

  void write() {
    ws_.text(out_.front().text);
    ws_.async_write(asio::buffer(out_.front().bytes),
                    [self = shared_from_this()](beast::error_code error, std::size_t) {
                      if (error) return self->leave();
                      self->waiting_ -= self->out_.front().bytes.size();
                      self->out_.pop_front();
                      if (self->closing_) return self->close();
                      if (!self->out_.empty()) self->write();
                    });
  }
  void close() {
    ws_.async_close(*closing_, [self = shared_from_this()](beast::error_code) {});
  }
  void leave() {
    if (std::exchange(gone_, true) || id_ == 0) return;
    all_.pages.erase(id_);
    if (all_.asking == id_) all_.asking = 0;
    if (all_.controller == id_) all_.give_control(all_.asking);
  }

  websocket::stream<beast::tcp_stream> ws_;
  asio::steady_timer greeting_;
  Pages& all_;
  beast::flat_buffer buffer_{};
  std::deque<Message> out_{};
  std::size_t waiting_ = 0, meshes_ = 0;  // [bytes]
  std::uint64_t id_ = 0, sent_ = 0, drawn_ = 0, shown_ = 0, missed_ = 0, skipped_ = 0;
  Clock::time_point second_{};
  int messages_ = 0;
  bool gone_ = false;
  std::optional<websocket::close_reason> closing_{};
};

void Pages::send_all(const std::string& text) {
  const std::map<std::uint64_t, Page*> now = pages;  // one that is too slow leaves
  for (const auto& [number, page] : now) page->send(text, true);
}

void Pages::give_control(std::uint64_t page) {
  session.let_go();
  controller = pages.contains(page) ? page : 0;
  asking = 0;
  tell_roles();
}

void Pages::tell_roles() {
  const std::map<std::uint64_t, Page*> now = pages;
  for (const auto& [number, page] : now)
    page->send({{"kind", "role"},
                {"role", number == controller ? "controller" : "viewer"},
                {"free", controller == 0},
                {"pages", pages.size()}});
}

/// One request: the page, or the door to the session. Anything else is told what is wrong.
class Door : public std::enable_shared_from_this<Door> {
 public:
  Door(tcp::socket socket, Pages& all) : stream_(std::move(socket)), all_(all) {}

  void read() {
    parser_.header_limit(8192);
    parser_.body_limit(0);
    stream_.expires_after(seconds(5));
    http::async_read(stream_, buffer_, parser_,
                     [self = shared_from_this()](beast::error_code error, std::size_t) {
                       if (!error) self->answer();
                     });
  }

 private:
  void answer() {
    const http::request<http::string_body>& request = parser_.get();
    if (request[http::field::host] != all_.host)
      return say(http::status::misdirected_request, "unknown host\n");
    if (websocket::is_upgrade(request)) return upgrade(request);
    if (request.method() != http::verb::get) return say(http::status::method_not_allowed, "GET only\n");
    for (const LiveAsset& asset : live_assets())
      if (request.target() == beast::string_view(asset.path.data(), asset.path.size()))
        return reply(http::status::ok, asset.type, asset.content);
    say(http::status::not_found, "no such page\n");
  }

  void upgrade(const http::request<http::string_body>& request) {
    if (request[http::field::origin] != all_.origin) return say(http::status::forbidden, "foreign origin\n");
    if (request.target() != "/live") return say(http::status::not_found, "no such door\n");
    if (request[http::field::sec_websocket_protocol] != kLiveProtocol)
      return say(http::status::bad_request, std::string("the protocol must be ") + kLiveProtocol + "\n");
    if (all_.pages.size() >= kPages || all_.sockets >= kSockets)
      return say(http::status::service_unavailable, "eight pages are enough\n");
    std::make_shared<Page>(stream_.release_socket(), all_)->accept(request);
  }

  void say(http::status status, const std::string& text) { reply(status, "text/plain; charset=utf-8", text); }
  void reply(http::status status, std::string_view type, std::string body) {
    response_ = {status, 11, std::move(body)};
    response_.set(http::field::content_type, beast::string_view(type.data(), type.size()));
    response_.set(
        "Content-Security-Policy",
        "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: "
        "blob:; worker-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'");
    response_.set("Cross-Origin-Opener-Policy", "same-origin");
    response_.set("Cross-Origin-Embedder-Policy", "require-corp");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Referrer-Policy", "no-referrer");
    response_.set(http::field::cache_control, "no-store");
    response_.keep_alive(false);
    response_.prepare_payload();
    http::async_write(stream_, response_, [self = shared_from_this()](beast::error_code, std::size_t) {
      beast::error_code ignored;
      self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  beast::tcp_stream stream_;
  Pages& all_;
  beast::flat_buffer buffer_{};
  http::request_parser<http::string_body> parser_{};
  http::response<http::string_body> response_{};
};

}  // namespace

struct Server::Impl {
  Impl(LiveSession& session, const ServerOptions& options) : all{.session = session} {
    const tcp::endpoint at{asio::ip::make_address(options.address), std::uint16_t(options.port)};
    acceptor.open(at.protocol());
    acceptor.set_option(asio::socket_base::reuse_address(true));
    acceptor.bind(at);
    acceptor.listen();
    const std::string shown = at.address().is_v6() ? "[" + options.address + "]" : options.address;
    all.host = shown + ":" + std::to_string(acceptor.local_endpoint().port());
    all.origin = "http://" + all.host;
    accept();
    beat();
  }

  void accept() {
    acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error == asio::error::operation_aborted) return;
      if (!error) {
        std::make_shared<Door>(std::move(socket), all)->read();
        return accept();
      }
      pause.expires_after(milliseconds(100));  // no descriptors are left, say
      pause.async_wait([this](beast::error_code stopped) {
        if (!stopped) accept();
      });
    });
  }

  // Frames and answers, sixty times a second.
  void beat() {
    timer.expires_after(kFrame);
    timer.async_wait([this](beast::error_code error) {
      if (error) return;
      for (const LiveAnswer& answer : all.session.answers()) pass_on(answer);
      if (all.asking != 0 && Clock::now() - all.asked > kAsked) all.give_control(all.asking);
      if (!all.pages.empty()) {
        const LiveFrame frame = all.session.frame();
        const std::map<std::uint64_t, Page*> now = all.pages;
        for (const auto& [id, page] : now) page->show(frame, all.session.origin());
      }
      beat();
    });
  }
  void pass_on(const LiveAnswer& answer) {
    if (answer.page == 0) return all.send_all(answer.text);
    if (const auto page = all.pages.find(answer.page); page != all.pages.end())
      page->second->send(answer.text, true);
  }

  Pages all;  // before what holds pages
  asio::io_context io{1};
  tcp::acceptor acceptor{io};
  asio::steady_timer timer{io}, pause{io};
};

Server::Server(LiveSession& session, const ServerOptions& options) {
  require_field(options.port >= 0 && options.port <= 65535, "ServerOptions::port", options.port,
                "lie in [0, 65535]");
  try {
    impl_ = std::make_unique<Impl>(session, options);
  } catch (const boost::system::system_error& error) {
    throw std::runtime_error("cannot listen at " + options.address + ":" + std::to_string(options.port) +
                             ": " + error.code().message());
  }
}

Server::~Server() = default;

std::string Server::address() const {
  return impl_->all.origin + "/#" + impl_->all.token;
}
int Server::port() const {
  return impl_->acceptor.local_endpoint().port();
}

void Server::run(const std::function<bool()>& go_on) {
  while (go_on() && !impl_->all.stop && !impl_->all.session.failed()) impl_->io.run_for(milliseconds(50));
  impl_->all.send_all(dump({{"kind", "closing"}, {"why", "the station ends"}}));
  impl_->io.run_for(milliseconds(100));
}

}  // namespace aussois
